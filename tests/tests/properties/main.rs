//! Properties of the equations of motion on random robots: trees of up to 12 joints with every kind of joint,
//! placement, body, rotor and force law, checked against Lagrange's equations and against each other.
//!
//! Tolerances are relative to the size of what is summed, see [`Scales`]: rounding errors of a recursion over
//! 12 joints are some hundred units of 1.1e-16 of it.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

mod derivatives;

use std::collections::BTreeSet;
use std::sync::LazyLock;

use fastrand::Rng;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::function::Function;
use gelenk_codegen::model::Model;
use gelenk_tests::dual::evaluate;
use gelenk_tests::oracle::Oracle;
use gelenk_tests::random_model::{
    Sample, condition_of, random_coupled_model, random_helical_model, random_model,
    random_model_with_frame_forces, random_model_with_near_rotors, random_sample,
};
use gelenk_tests::{Robot, in_parallel};
use num_dual::{Dual64, HyperDual64};

/// Rounding error relative to [`Scales`].
const TOLERANCE: f64 = 1e-12;

/// Robots of each test; every seed is another robot.
const SEEDS: std::ops::Range<u64> = 0..30;

/// Robots with joints that follow others.
const COUPLED_SEEDS: std::ops::Range<u64> = 1000..1010;

/// Robots with forces, inputs and wrenches at frames.
const FORCE_SEEDS: std::ops::Range<u64> = 3000..3012;

/// Robots with helical joints, some of which follow others.
const HELICAL_SEEDS: std::ops::Range<u64> = 2000..2008;

/// Largest number of coordinates.
const LONGEST: usize = 12;

/// States in which each robot is tried.
const STATES: usize = 3;

/// One robot in one state.
struct Case<'a> {
    seed: u64,
    robot: &'a Robot,
    state: &'a Sample,
    oracle: Oracle<'a>,
    scales: Scales,
}

/// Sizes of what is summed, by kind: errors are relative to them.
struct Scales {
    /// Largest entry of M.
    mass: f64,
    /// Scale of M ÿ.
    inertial: f64,
    /// Scale of k, whose terms are products of derivatives of M and two velocities; lengths here are up to a
    /// few metres.
    coriolis: f64,
    /// Scale of gravity's forces.
    gravity: f64,
    /// Scale of springs, friction and inputs.
    other: f64,
}

impl Scales {
    fn of(oracle: &Oracle, state: &Sample) -> Self {
        let largest = |a: &[f64]| a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let sum = |a: &[f64]| a.iter().map(|x| x.abs()).sum::<f64>();
        let still = vec![0.0; state.y.len()];
        let mass = largest(&oracle.mass_matrix(&state.y));
        let coriolis = largest(&oracle.inertial_forces(&state.y, &state.v, &still));
        let springs = largest(&oracle.spring_forces(&state.y, &state.v));
        let friction = largest(&oracle.friction_torques(&state.y, &state.v));
        let inputs = largest(&joint_forces(oracle, &state.y, &state.u));
        Self {
            mass,
            inertial: mass * sum(&state.a),
            coriolis: coriolis + mass * sum(&state.v).powi(2),
            gravity: largest(&oracle.gravity_forces(&state.y)),
            other: springs + friction + inputs,
        }
    }

    fn forces(&self) -> f64 {
        self.inertial + self.coriolis + self.gravity + self.other
    }
}

/// `B u`
fn joint_forces(oracle: &Oracle, y: &[f64], u: &[f64]) -> Vec<f64> {
    let columns = oracle.input_columns(y);
    (0..y.len()).map(|i| columns.iter().zip(u).map(|(column, u)| column[i] * u).sum()).collect()
}

impl Case<'_> {
    fn function(&self, name: &str) -> &Function {
        self.robot.function(name)
    }

    fn call(&self, name: &str, inputs: &[&[f64]]) -> Vec<f64> {
        self.call_all(name, inputs).swap_remove(0)
    }

    /// B, rows first.
    fn input_matrix(&self) -> Vec<f64> {
        match self.oracle.model.inputs_depend_on_position() {
            true => self.call("input_matrix", &[&self.state.y]),
            false => self.call("input_matrix", &[]),
        }
    }

    /// Friction torques at the state.
    fn friction(&self) -> Vec<f64> {
        let name = "friction_torques";
        let arguments = self.robot.friction_arguments(name, &self.state.y, &self.state.v);
        self.call(name, &arguments)
    }

    fn call_all(&self, name: &str, inputs: &[&[f64]]) -> Vec<Vec<f64>> {
        self.robot.call_with(name, inputs, &self.state.parameters)
    }

    /// The derivative of a function's first result along a path.
    fn rate(&self, name: &str, inputs: &[&[Dual64]]) -> Vec<f64> {
        let program = &self.function(name).program;
        let mut results = evaluate(program, inputs, &self.state.parameters);
        results.swap_remove(0).iter().map(|x| x.eps).collect()
    }

    fn close(&self, what: &str, found: &[f64], expected: &[f64], scale: f64) {
        assert_eq!(found.len(), expected.len(), "seed {}: {what}", self.seed);
        for (index, (a, b)) in found.iter().zip(expected).enumerate() {
            let error = (a - b).abs() / scale.max(f64::MIN_POSITIVE);
            assert!(
                error <= TOLERANCE,
                "seed {}: {what}[{index}] is {a:e}, expected {b:e}: {error:.1e} of {scale:.1e}",
                self.seed
            );
        }
    }
}

/// Checked functions.
const FUNCTIONS: [&str; 17] = [
    "mass_matrix",
    "coriolis_forces",
    "gravity_forces",
    "spring_forces",
    "friction_torques",
    "applied_forces",
    "bias_forces",
    "input_matrix",
    "equations_of_motion",
    "inverse_dynamics",
    "forward_dynamics",
    "kinetic_energy",
    "potential_energy",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics_derivatives",
    "linearize",
];

/// Additional functions of robots with wrenches.
const WITH_WRENCHES: [&str; 6] = [
    "wrench_forces",
    "wrench_forces_derivatives",
    "inverse_dynamics_with_wrenches",
    "forward_dynamics_with_wrenches",
    "inverse_dynamics_derivatives_with_wrenches",
    "forward_dynamics_derivatives_with_wrenches",
];

/// Kinds of random robots.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Straight,
    /// The array form of robots without couplings knows no rotors that sit further from their joint than on its parent.
    Looped,
    Coupled,
    CoupledLooped,
    Helical,
    HelicalLooped,
    WithForces,
}

fn derived(kind: Kind, seed: u64) -> Robot {
    let selection = [&FUNCTIONS[..], &["frames"]].concat();
    let with_wrenches = [&selection[..], &WITH_WRENCHES].concat();
    let of = |model, form| Robot::in_form(model, &selection, form);
    match kind {
        Kind::Straight => of(random_model(seed, LONGEST), Form::Straight),
        Kind::Looped => of(random_model_with_near_rotors(seed, LONGEST), Form::Arrays),
        Kind::Coupled => of(random_coupled_model(seed, LONGEST), Form::Straight),
        Kind::CoupledLooped => of(random_coupled_model(seed, LONGEST), Form::Arrays),
        Kind::Helical => of(random_helical_model(seed, LONGEST), Form::Straight),
        Kind::HelicalLooped => of(random_helical_model(seed, LONGEST), Form::Arrays),
        Kind::WithForces => {
            let model = random_model_with_frame_forces(seed, LONGEST);
            Robot::in_form(model, &with_wrenches, Form::Cheapest)
        }
    }
}

/// All random robots with their seeds, derived once for all tests.
static ROBOTS: LazyLock<Vec<(u64, Robot)>> = LazyLock::new(|| {
    let plain = SEEDS.flat_map(|seed| [(Kind::Straight, seed), (Kind::Looped, seed)]);
    let coupled = COUPLED_SEEDS.flat_map(|seed| [(Kind::Coupled, seed), (Kind::CoupledLooped, seed)]);
    let helical = HELICAL_SEEDS.flat_map(|seed| [(Kind::Helical, seed), (Kind::HelicalLooped, seed)]);
    let with_forces = FORCE_SEEDS.map(|seed| (Kind::WithForces, seed));
    let all: Vec<(Kind, u64)> = plain.chain(coupled).chain(helical).chain(with_forces).collect();
    let robots = in_parallel(&all, |&(kind, seed)| derived(kind, seed));
    for (kind, seeds) in
        [(Kind::Looped, SEEDS), (Kind::CoupledLooped, COUPLED_SEEDS), (Kind::HelicalLooped, HELICAL_SEEDS)]
    {
        let looped = || all.iter().zip(&robots).filter(|((found, _), _)| *found == kind);
        for name in ["inverse_dynamics_derivatives", "linearize"] {
            let has_loops = looped().filter(|(_, robot)| robot.function(name).arrays.is_some());
            assert!(has_loops.count() > 2 * seeds.clone().count() / 3, "{name}");
        }
    }
    all.iter().map(|&(_, seed)| seed).zip(robots).collect()
});

/// Runs a check on all random robots, in several states.
fn on_all(check: impl Fn(&Case)) {
    for &(seed, ref robot) in ROBOTS.iter() {
        let mut rng = Rng::with_seed(seed ^ 0x5eed);
        for _ in 0..STATES {
            let state = random_sample(&mut rng, &robot.model);
            let oracle = Oracle { model: &robot.model, parameters: &state.parameters };
            check(&Case { seed, robot, state: &state, scales: Scales::of(&oracle, &state), oracle });
        }
    }
}

fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(matrix: &[f64], x: &[f64]) -> Vec<f64> {
    matrix.chunks(x.len()).map(|row| dot(row, x)).collect()
}

/// `y + ẏ t`, as a path.
fn path(y: &[f64], rate: &[f64]) -> Vec<Dual64> {
    y.iter().zip(rate).map(|(&y, &v)| Dual64::new(y, v)).collect()
}

#[test]
fn mass_matrix_is_that_of_the_kinetic_energy() {
    on_all(|case| {
        let (y, v) = (&case.state.y, &case.state.v);
        let mass = case.call("mass_matrix", &[y]);
        let expected = case.oracle.mass_matrix(y);
        case.close("M", &mass, &expected, case.scales.mass);
        let n = y.len();
        for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
            assert_eq!(mass[i * n + j].to_bits(), mass[j * n + i].to_bits());
        }
        assert!(condition_of(&mass).is_finite(), "seed {}", case.seed);
        let energy = case.call("kinetic_energy", &[y, v]);
        let expected = case.oracle.kinetic_energy(y, v);
        let size = case.scales.mass * v.iter().map(|v| v.abs()).sum::<f64>().powi(2);
        case.close("T", &energy, &[expected], size);
        case.close("½ẏᵀMẏ", &energy, &[0.5 * dot(v, &times(&mass, v))], size);
    });
}

#[test]
fn forces_are_those_of_lagrange() {
    on_all(|case| {
        let (y, v, a) = (&case.state.y, &case.state.v, &case.state.a);
        let (oracle, scales) = (&case.oracle, &case.scales);
        let still = vec![0.0; y.len()];
        let coriolis = oracle.inertial_forces(y, v, &still);
        let gravity = oracle.gravity_forces(y);
        let k = case.call("coriolis_forces", &[y, v]);
        case.close("k", &k, &coriolis, scales.coriolis);
        case.close("g", &case.call("gravity_forces", &[y]), &gravity, scales.gravity);
        let bias = case.call("bias_forces", &[y, v]);
        let size = scales.coriolis + scales.gravity;
        case.close("bias", &bias, &minus(&coriolis, &gravity), size);
        let forces = minus(&oracle.spring_forces(y, v), &oracle.friction_torques(y, v));
        let forces = plus(&forces, &gravity);
        let expected = minus(&oracle.inertial_forces(y, v, a), &forces);
        let found = case.call("inverse_dynamics", &[y, v, a]);
        case.close("M ÿ + k − q", &found, &expected, scales.forces());
    });
}

/// Each part of q and its sign: gravity drives, a stretched spring pulls back, friction brakes.
#[test]
fn applied_forces_are_the_sum_of_their_parts() {
    on_all(|case| {
        let (y, v, oracle) = (&case.state.y, &case.state.v, &case.oracle);
        let size = case.scales.gravity + case.scales.other;
        let springs = case.call("spring_forces", &[y, v]);
        case.close("springs", &springs, &oracle.spring_forces(y, v), size);
        let friction = case.friction();
        case.close("τ", &friction, &oracle.friction_torques(y, v), size);
        let gravity = oracle.gravity_forces(y);
        let expected = minus(&plus(&gravity, &springs), &friction);
        case.close("q", &case.call("applied_forces", &[y, v]), &expected, size);
    });
}

#[test]
fn mass_matrix_has_the_columns_of_inverse_dynamics() {
    on_all(|case| {
        let (y, v, n) = (&case.state.y, &case.state.v, case.state.y.len());
        let mass = case.call("mass_matrix", &[y]);
        let bias = case.call("inverse_dynamics", &[y, v, &vec![0.0; n]]);
        for j in 0..n {
            let a: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == j))).collect();
            let column: Vec<f64> = (0..n).map(|i| mass[i * n + j]).collect();
            let found = minus(&case.call("inverse_dynamics", &[y, v, &a]), &bias);
            case.close("M e", &found, &column, case.scales.forces());
        }
    });
}

#[test]
fn equations_of_motion_are_their_parts() {
    on_all(|case| {
        let (y, v, scales) = (&case.state.y, &case.state.v, &case.scales);
        let all = case.call_all("equations_of_motion", &[y, v]);
        case.close("M", &all[0], &case.call("mass_matrix", &[y]), scales.mass);
        case.close("k", &all[1], &case.call("coriolis_forces", &[y, v]), scales.coriolis);
        let size = scales.gravity + scales.other;
        case.close("q", &all[2], &case.call("applied_forces", &[y, v]), size);
    });
}

/// Residual and error: the latter grows with the condition number of M.
#[test]
fn forward_dynamics_inverts_inverse_dynamics() {
    on_all(|case| {
        let Sample { y, v, a, u, .. } = case.state;
        let input_matrix = case.input_matrix();
        let inputs = if u.is_empty() { vec![0.0; y.len()] } else { times(&input_matrix, u) };
        let size = case.scales.forces();
        case.close("B u", &inputs, &joint_forces(&case.oracle, y, u), size);
        let accelerations = case.call("forward_dynamics", &[y, v, u]);
        let forces = case.call("inverse_dynamics", &[y, v, &accelerations]);
        let largest = accelerations.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let residual = size + case.scales.mass * largest * y.len() as f64;
        case.close("M ÿ + k − q − B u", &forces, &inputs, residual);
        let column = |j: usize| (0..y.len()).find(|i| input_matrix[i * u.len() + j] != 0.0);
        let driven: BTreeSet<usize> = (0..u.len()).filter_map(column).collect();
        let are_drives = case.oracle.model.force_inputs.is_empty() && !case.oracle.model.is_coupled();
        if u.len() == y.len() && driven.len() == y.len() && are_drives {
            // Every coordinate is driven, B is diagonal up to the order of the drives.
            let forces = case.call("inverse_dynamics", &[y, v, a]);
            let input = |j: usize| {
                let i = column(j).expect("a drive moves a coordinate");
                forces[i] / input_matrix[i * u.len() + j]
            };
            let u: Vec<f64> = (0..u.len()).map(input).collect();
            let found = case.call("forward_dynamics", &[y, v, &u]);
            let mass = case.call("mass_matrix", &[y]);
            let growth = condition_of(&mass) * size / case.scales.mass;
            case.close("ÿ", &found, a, growth);
        }
    });
}

/// `d(T + V)/dt = ẏᵀ (B u + springs − τ)` on the motion that the inputs cause, without the springs in V.
#[test]
fn power_balance() {
    on_all(|case| {
        let Sample { y, v, u, .. } = case.state;
        let accelerations = case.call("forward_dynamics", &[y, v, u]);
        let (y_path, v_path) = (path(y, v), path(v, &accelerations));
        let kinetic = case.rate("kinetic_energy", &[&y_path, &v_path])[0];
        let potential = case.rate("potential_energy", &[&y_path])[0];
        let springs = case.call("spring_forces", &[y, v]);
        let springs = minus(&springs, &case.oracle.law_forces_at_rest(y));
        let friction = case.friction();
        let forces = plus(&joint_forces(&case.oracle, y, u), &minus(&springs, &friction));
        let speed: f64 = v.iter().map(|v| v.abs()).sum();
        let inertial = accelerations.iter().map(|a| a.abs()).sum::<f64>() * case.scales.mass;
        let size = speed * (case.scales.forces() + inertial);
        case.close("Ė", &[kinetic + potential], &[dot(v, &forces)], size);
    });
}

/// `ẏᵀ (½ Ṁ ẏ − k) = 0`: what Ṁ − 2C being skew-symmetric says of k.
#[test]
fn coriolis_forces_do_no_work_beyond_the_mass_matrix() {
    on_all(|case| {
        let (y, v) = (&case.state.y, &case.state.v);
        let rate = case.rate("mass_matrix", &[&path(y, v)]);
        let k = case.call("coriolis_forces", &[y, v]);
        let half: Vec<f64> = times(&rate, v).iter().map(|x| 0.5 * x).collect();
        let speed: f64 = v.iter().map(|v| v.abs()).sum();
        let size = case.scales.coriolis * speed;
        case.close("ẏᵀ(½Ṁẏ − k)", &[dot(v, &minus(&half, &k))], &[0.0], size);
    });
}

#[test]
fn forces_with_an_energy_are_the_slope_of_the_potential_energy() {
    on_all(|case| {
        let y = &case.state.y;
        let slope = |j: usize| {
            let direction: Vec<f64> = (0..y.len()).map(|i| f64::from(u8::from(i == j))).collect();
            -case.rate("potential_energy", &[&path(y, &direction)])[0]
        };
        let expected: Vec<f64> = (0..y.len()).map(slope).collect();
        let of_laws = case.oracle.law_forces_at_rest(y);
        let found = plus(&case.call("gravity_forces", &[y]), &of_laws);
        let springs: f64 = of_laws.iter().map(|force| force.abs()).sum();
        case.close("−∂V/∂y", &found, &expected, case.scales.gravity + springs);
        if !case.oracle.model.point_forces.is_empty() {
            return;
        }
        let energy = case.oracle.potential_energy(y);
        // Lengths are up to 12 × 0.9 m: the energies of the bodies may cancel.
        let model: &Model = case.oracle.model;
        let size = 10.0 * case.scales.gravity + energy.abs() + model.links.len() as f64;
        case.close("V", &case.call("potential_energy", &[y]), &[energy], size);
    });
}

#[test]
fn frames_are_where_the_links_carry_them() {
    on_all(|case| {
        let (y, v, oracle) = (&case.state.y, &case.state.v, &case.oracle);
        // Each joint lies at most 0.9 m from the one before it or slides by π m.
        let reach = 4.0 * oracle.model.links.len() as f64;
        let speed: f64 = v.iter().map(|v| v.abs()).sum();
        for frame in &oracle.model.frames {
            let name = |suffix: &str| format!("frame_{}_{suffix}", frame.identifier);
            let (origin, rotation) = oracle.frame(frame, y);
            let pose = case.call_all(&name("pose"), &[y]);
            case.close("p", &pose[0], &origin, reach);
            case.close("R", &pose[1], rotation.as_flattened(), 1.0);
            let jacobian = case.call(&name("jacobian"), &[y]);
            for j in 0..y.len() {
                let column: Vec<f64> = (0..6).map(|i| jacobian[i * y.len() + j]).collect();
                case.close("J", &column, &oracle.jacobian_column(frame, y, j), reach);
            }
            let found = case.call(&name("jacobian_rate_times_velocity"), &[y, v]);
            let expected = oracle.jacobian_rate_times_velocity(frame, y, v);
            case.close("J̇ẏ", &found, &expected, reach * speed * speed);
            // The product's own pose, differentiated twice along y + ẏ t.
            let path: Vec<_> = (0..y.len()).map(|i| HyperDual64::new(y[i], v[i], v[i], 0.0)).collect();
            let program = &case.function(&name("pose")).program;
            let pose = evaluate(program, &[&path], &case.state.parameters);
            let second: Vec<f64> = pose[0].iter().map(|x| x.eps1eps2).collect();
            case.close("p̈", &found[..3], &second, reach * speed * speed);
        }
    });
}

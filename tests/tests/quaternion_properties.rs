//! Random robots with spherical and floating joints, with rotors, springs, friction, couplings and forces at frames: against
//! Lagrange's equations in the angles of a chain of joints, and derivatives along ⊕ against dual numbers.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use fastrand::Rng;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::model::Model;
use gelenk_tests::Robot;
use gelenk_tests::dual::evaluate;
use gelenk_tests::oracle::Oracle;
use gelenk_tests::quaternion_model::{positions, rates, velocities, with_quaternions};
use gelenk_tests::random_model::{
    Sample, random_coupled_model, random_helical_model, random_model, random_model_with_frame_forces,
    random_sample,
};
use num_dual::Dual64;

/// Of rounding, relative to the largest of what is compared.
const TOLERANCE: f64 = 1e-10;

const FUNCTIONS: [&str; 9] = [
    "mass_matrix",
    "inverse_dynamics",
    "friction_torques",
    "inverse_dynamics_derivatives_and_mass_matrix",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "inertial_parameters",
    "inertial_regressor",
    "linearize",
];

/// Of robots with wrenches.
const WITH_WRENCHES: [&str; 4] = [
    "inverse_dynamics_with_wrenches",
    "inverse_dynamics_derivatives_with_wrenches",
    "forward_dynamics_with_wrenches",
    "forward_dynamics_derivatives_with_wrenches",
];

/// What is derived of a robot.
fn names(model: &Model) -> Vec<&'static str> {
    let wrenches = WITH_WRENCHES.iter().take(4 * usize::from(!model.wrenches.is_empty()));
    FUNCTIONS.iter().chain(wrenches).copied().collect()
}

fn models() -> impl Iterator<Item = (u64, Model)> {
    let kinds: [fn(u64, usize) -> Model; 4] =
        [random_model, random_coupled_model, random_helical_model, random_model_with_frame_forces];
    (0..20).map(move |seed| {
        let kind = kinds[usize::try_from(seed % 4).expect("small")];
        (seed, with_quaternions(kind(seed, 5), seed))
    })
}

fn close(what: &str, found: &[f64], expected: &[f64], size: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs();
        assert!(error <= TOLERANCE * size, "{what}, {k}: {found} is not {expected}, of {size}");
    }
}

fn largest<'a>(all: impl IntoIterator<Item = &'a f64>) -> f64 {
    all.into_iter().fold(1e-3, |most: f64, x| most.max(x.abs()))
}

/// `Jᵀ f` for the velocities `J v` of the chain's ones.
fn to_chain(model: &Model, y: &[f64], forces: &[f64]) -> Vec<f64> {
    let unit = |k: usize| (0..y.len()).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
    let column = |k: usize| velocities(model, y, &unit(k));
    (0..y.len()).map(|k| column(k).iter().zip(forces).map(|(j, f)| j * f).sum()).collect()
}

/// What has loops over joints.
const LOOPS: [&str; 3] =
    ["inverse_dynamics_derivatives_and_mass_matrix", "forward_dynamics_derivatives", "linearize"];

/// Checks a robot as straight-line code, and as loops over joints where there are some; how many functions have these.
fn check(seed: u64, model: Model) -> usize {
    let names = names(&model);
    check_robot(seed, &Robot::in_form(model.clone(), &names, Form::Straight));
    let looped = Robot::in_form(model, &names, Form::Arrays);
    let count = LOOPS.iter().filter(|name| looped.function(name).arrays.is_some()).count();
    if count > 0 {
        check_robot(seed, &looped);
    }
    count
}

fn check_robot(seed: u64, robot: &Robot) {
    let model = &robot.model;
    let mut rng = Rng::with_seed(seed);
    for state in 0..2 {
        let Sample { y: angles, v: rates_of_angles, a, u, parameters } = random_sample(&mut rng, model);
        let oracle = Oracle { model, parameters: &parameters };
        let y = positions(model, &angles);
        let dual = |x: &[f64], rate: &[f64]| -> Vec<Dual64> {
            x.iter().zip(rate).map(|(&x, &rate)| Dual64::new(x, rate)).collect()
        };
        let moving = velocities(model, &dual(&angles, &rates_of_angles), &dual(&rates_of_angles, &a));
        let v: Vec<f64> = moving.iter().map(|x| x.re).collect();
        let accelerations: Vec<f64> = moving.iter().map(|x| x.eps).collect();
        let what = |name: &str| format!("seed {seed}, state {state}, {name}");
        let inputs: [&[f64]; 3] = [&y, &v, &accelerations];
        let forces = robot.call_with("inverse_dynamics", &inputs, &parameters).swap_remove(0);
        let inertial = oracle.inertial_forces(&angles, &rates_of_angles, &a);
        let gravity = oracle.gravity_forces(&angles);
        let springs = oracle.spring_forces(&angles, &rates_of_angles);
        let friction = oracle.friction_torques(&angles, &rates_of_angles);
        let expected: Vec<f64> =
            (0..angles.len()).map(|k| inertial[k] - gravity[k] - springs[k] + friction[k]).collect();
        let size = largest(inertial.iter().chain(&gravity).chain(&springs).chain(&friction));
        close(&what("inverse dynamics"), &to_chain(model, &angles, &forces), &expected, size);
        let found = to_chain(model, &angles, &bodies_forces(robot, &inputs, &parameters));
        let expected: Vec<f64> = (0..angles.len()).map(|k| inertial[k] - gravity[k]).collect();
        close(&what("W π"), &found, &expected, size);
        let arguments = robot.friction_arguments("friction_torques", &y, &v);
        let found = robot.call_with("friction_torques", &arguments, &parameters).swap_remove(0);
        close(&what("friction"), &to_chain(model, &angles, &found), &friction, largest(&friction));
        let wrenches: Vec<f64> = (0..6 * model.wrenches.len()).map(|_| rng.f64() - 0.5).collect();
        let (w, a, forces) = (wrenches.as_slice(), accelerations.as_slice(), u.as_slice());
        for (plain, derived, more) in [
            ("inverse_dynamics", "inverse_dynamics_derivatives_and_mass_matrix", &[a][..]),
            ("forward_dynamics", "forward_dynamics_derivatives", &[forces][..]),
            (WITH_WRENCHES[0], WITH_WRENCHES[1], &[a, w][..]),
            (WITH_WRENCHES[2], WITH_WRENCHES[3], &[forces, w][..]),
        ] {
            if names(model).contains(&plain) {
                by_dual_numbers(robot, &what(plain), [&y, &v], more, &parameters, [plain, derived]);
            }
        }
        motion_agrees(robot, &what, &oracle, [&angles, &y, &v, &u, &wrenches], size);
        linearization_agrees(robot, &what("linearize"), [&y, &v, &u], &parameters);
        drift_agrees(robot, &what("D"), [&y, &v, &u], &parameters);
    }
}

/// `W π`
fn bodies_forces(robot: &Robot, inputs: &[&[f64]], parameters: &[f64]) -> Vec<f64> {
    let regressor = robot.call_with("inertial_regressor", inputs, parameters).swap_remove(0);
    let pi = robot.call_with("inertial_parameters", &[], parameters).swap_remove(0);
    regressor.chunks(pi.len()).map(|row| row.iter().zip(&pi).map(|(w, p)| w * p).sum()).collect()
}

/// The accelerations that inputs cause take those inputs' forces: `M ÿ + k − q = B u`, less the forces of wrenches where
/// these push. The forces are those of virtual work in the angles of the chain.
///
/// - `size`: largest of the forces that inverse dynamics add up
fn motion_agrees(
    robot: &Robot,
    what: &dyn Fn(&str) -> String,
    oracle: &Oracle<'_>,
    [angles, y, v, u, wrenches]: [&[f64]; 5],
    size: f64,
) {
    let model = &robot.model;
    let call =
        |name: &str, inputs: &[&[f64]]| robot.call_with(name, inputs, oracle.parameters).swap_remove(0);
    let columns = oracle.input_columns(angles);
    let of_inputs = |k: usize| columns.iter().zip(u).map(|(column, u)| column[k] * u).sum::<f64>();
    let inputs: Vec<f64> = (0..angles.len()).map(of_inputs).collect();
    let mass = largest(&call("mass_matrix", &[y])) * angles.len() as f64;
    let size_with = |accelerations: &[f64]| {
        let forces = largest(inputs.iter().chain(wrenches));
        size + forces + mass * largest(accelerations)
    };
    let accelerations = call("forward_dynamics", &[y, v, u]);
    let forces = to_chain(model, angles, &call("inverse_dynamics", &[y, v, &accelerations]));
    close(&what("M ÿ + k − q"), &forces, &inputs, size_with(&accelerations));
    if model.wrenches.is_empty() {
        return;
    }
    let accelerations = call("forward_dynamics_with_wrenches", &[y, v, u, wrenches]);
    let own = call("inverse_dynamics", &[y, v, &accelerations]);
    let less = call("inverse_dynamics_with_wrenches", &[y, v, &accelerations, wrenches]);
    let less = to_chain(model, angles, &less);
    close(&what("M ÿ + k − q with wrenches"), &less, &inputs, size_with(&accelerations));
    let pushed: Vec<f64> =
        to_chain(model, angles, &own).iter().zip(&less).map(|(own, less)| own - less).collect();
    let expected = oracle.wrench_forces(angles, wrenches);
    close(&what("forces of wrenches"), &pushed, &expected, size_with(&accelerations));
}

/// Derivatives of a function by positions along ⊕ and by velocities, of one that has them as its second and third result.
fn by_dual_numbers(
    robot: &Robot,
    what: &str,
    [y, v]: [&[f64]; 2],
    more: &[&[f64]],
    parameters: &[f64],
    [plain, derived]: [&str; 2],
) {
    let n = v.len();
    let program = &robot.function(plain).program;
    let found = robot.call_with(derived, &[&[y, v], more].concat(), parameters);
    let more: Vec<Vec<Dual64>> = more.iter().map(|x| with_rates(x, &vec![0.0; x.len()])).collect();
    let column = |position: Option<usize>, velocity: Option<usize>| -> Vec<f64> {
        let along = |k: Option<usize>| k.map_or(vec![0.0; n], |k| unit(n, k));
        let moving = with_rates(y, &rates(&robot.model, y, &along(position)));
        let v = with_rates(v, &along(velocity));
        let inputs: Vec<&[Dual64]> = [&moving, &v].into_iter().chain(&more).map(Vec::as_slice).collect();
        evaluate(program, &inputs, parameters)[0].iter().map(|x| x.eps).collect()
    };
    for (result, of_position) in [(1, true), (2, false)] {
        let size = largest(&found[result]);
        for k in 0..n {
            let expected = if of_position { column(Some(k), None) } else { column(None, Some(k)) };
            let column: Vec<f64> = (0..n).map(|i| found[result][i * n + k]).collect();
            close(&format!("{what} result {result} column {k}"), &column, &expected, size);
        }
    }
}

fn with_rates(x: &[f64], rates: &[f64]) -> Vec<Dual64> {
    x.iter().zip(rates).map(|(&x, &rate)| Dual64::new(x, rate)).collect()
}

fn unit(n: usize, k: usize) -> Vec<f64> {
    (0..n).map(|i| f64::from(u8::from(i == k))).collect()
}

/// D is what the rates of positions make of a small motion: `T(y) D δ = ∂(T v)/∂y T δ − ∂(T δ)/∂y T v`.
fn drift_agrees(robot: &Robot, what: &str, inputs: [&[f64]; 3], parameters: &[f64]) {
    let (model, [y, v, _]) = (&robot.model, inputs);
    let n = v.len();
    let drift = &robot.call_with("linearize", &inputs, parameters)[4];
    let change = |of: &[f64], along: &[f64]| -> Vec<f64> {
        let moving = with_rates(y, &rates(model, y, along));
        let of = with_rates(of, &vec![0.0; n]);
        rates(model, &moving, &of).iter().map(|rate| rate.eps).collect()
    };
    for k in 0..n {
        let small = unit(n, k);
        let column: Vec<f64> = (0..n).map(|i| drift[i * n + k]).collect();
        let (first, second) = (change(v, &small), change(&small, v));
        let expected: Vec<f64> = first.iter().zip(&second).map(|(a, b)| a - b).collect();
        close(&format!("{what} column {k}"), &rates(model, y, &column), &expected, largest(v));
    }
}

fn linearization_agrees(robot: &Robot, what: &str, inputs: [&[f64]; 3], parameters: &[f64]) {
    let linear = robot.call_with("linearize", &inputs, parameters);
    let derived = robot.call_with("forward_dynamics_derivatives", &inputs, parameters);
    close(&format!("{what} A_v"), &linear[1], &derived[2], largest(&derived[2]));
    let [_, v, u] = inputs;
    let (n, m) = (v.len(), u.len());
    let at = |i: usize| {
        let by_v: f64 = (0..n).map(|j| linear[1][i * n + j] * v[j]).sum();
        let by_u: f64 = (0..m).map(|j| linear[2][i * m + j] * u[j]).sum();
        by_v + by_u + linear[3][i]
    };
    let whole: Vec<f64> = (0..n).map(at).collect();
    let size = largest(linear[1].iter().chain(&linear[2]).chain(&derived[0]));
    close(&format!("{what} c"), &whole, &derived[0], 10.0 * size);
}

#[test]
fn chains_of_joints_move_alike() {
    let mut floating = 0;
    let mut spherical = 0;
    let mut carried = 0;
    let mut pushed = 0;
    let mut all_loops = 0;
    for (seed, model) in models() {
        for joint in &model.quaternion_joints {
            let count = if joint.kind.velocities() == 6 { &mut floating } else { &mut spherical };
            *count += 1;
            carried += usize::from(joint.kind.velocities() == 6 && joint.name == "ball");
        }
        pushed += usize::from(!model.wrenches.is_empty());
        let count = check(seed, model);
        all_loops += usize::from(count == LOOPS.len());
    }
    // Those with forces at frames have none, and `linearize` computes gains that are products of parameters.
    assert!(all_loops >= 12, "{all_loops} with loops");
    assert!(floating >= 8 && spherical >= 8, "{floating} floating, {spherical} spherical");
    assert!(carried >= 2, "{carried} floating joints on arms");
    assert!(pushed >= 2, "{pushed} with wrenches");
}

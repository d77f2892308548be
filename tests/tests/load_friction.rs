//! Friction that grows with the load: `models/geared_arm.toml` against its equations written down by hand, with
//! loads found by bisection and Jacobians from dual numbers and the implicit function theorem.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

use fastrand::Rng;
use gelenk_codegen::functions::form::Form;
use gelenk_codegen::functions::selection::derive_functions;
use gelenk_codegen::functions::size::MOST_OPERATIONS;
use gelenk_codegen::pipeline::GenerateOptions;
use gelenk_codegen::read::ReadOptions;
use gelenk_runtime::dynamics::{Differentiable, Discretizable, Dynamics};
use gelenk_tests::dual::Number;
use gelenk_tests::{Robot, workspace};
use num_dual::Dual64;

gelenk_runtime::dynamics!(struct Arm = gelenk_generated::geared_arm);

const G: f64 = 9.81;
const GEARS: [f64; 2] = [100.0, -80.0];

/// `M ÿ + k − q` without friction, of two links with parallel horizontal axes (Craig, *Introduction to Robotics*,
/// section 6.7, with inertias and the rotors of geared motors).
fn loads<T: Number>([y, v, a]: [[T; 2]; 3]) -> [T; 2] {
    let (m2, l, c2) = (2.0, 0.45, 0.18);
    let h = m2 * l * c2;
    let (near, far) = (0.08 + 4.0 * 0.2 * 0.2 + m2 * l * l, 0.03 + m2 * c2 * c2);
    // The first rotor stands on the base; the second has no coupling.
    let rotors = [4e-5 * GEARS[0] * GEARS[0], 3e-5 * GEARS[1] * GEARS[1]];
    let (c, s) = (y[1].cos(), y[1].sin());
    let m11 = c * (2.0 * h) + (near + far + rotors[0]);
    let m12 = c * h + far;
    let k = [-(s * h) * (v[0] * v[1] * 2.0 + v[1] * v[1]), s * h * v[0] * v[0]];
    let beyond = (y[0] + y[1]).sin() * (m2 * c2 * G);
    let gravity = [y[0].sin() * ((4.0 * 0.2 + m2 * l) * G) + beyond, beyond];
    let spring = -(y[1] - 0.3) * 4.0 - v[1] * 0.2;
    [
        m11 * a[0] + m12 * a[1] + k[0] - gravity[0],
        m12 * a[0] + a[1] * (far + rotors[1]) + k[1] - gravity[1] - spring,
    ]
}

fn friction<T: Number>(v: [T; 2]) -> [T; 2] {
    [v[0] * 3.0 + (v[0] * 20.0).tanh() * 1.2, v[1] + (v[1] * 20.0).tanh() * 0.5]
}

fn shares<T: Number>(y: [T; 2], v: [T; 2]) -> [T; 2] {
    [(v[0] * 20.0).tanh() * 0.15, ((y[1] * 2.0).cos() * 0.03 + 0.1) * (v[1] * 20.0).tanh()]
}

fn inverse<T: Number>([y, v, a]: [[T; 2]; 3]) -> [T; 2] {
    let (loads, friction, shares) = (loads([y, v, a]), friction(v), shares(y, v));
    std::array::from_fn(|i| loads[i] + friction[i] + loads[i].abs() * shares[i])
}

/// The load with which a drive exerts so much, by bisection.
fn load_of(exerted: f64, friction: f64, share: f64) -> f64 {
    let [mut low, mut high] = [-1e4, 1e4];
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        match middle + friction + middle.abs() * share < exerted {
            true => low = middle,
            false => high = middle,
        }
    }
    0.5 * (low + high)
}

/// ÿ: the loads by bisection, the accelerations by Cramer's rule.
fn forward(y: [f64; 2], v: [f64; 2], u: [f64; 2]) -> [f64; 2] {
    let (friction, shares) = (friction(v), shares(y, v));
    let still = loads([y, v, [0.0; 2]]);
    let r: [f64; 2] = std::array::from_fn(|i| load_of(GEARS[i] * u[i], friction[i], shares[i]) - still[i]);
    let column = |j: usize| {
        let mut a = [0.0; 2];
        a[j] = 1.0;
        let forces = loads([y, v, a]);
        [forces[0] - still[0], forces[1] - still[1]]
    };
    let (first, second) = (column(0), column(1));
    let determinant = first[0] * second[1] - second[0] * first[1];
    [(r[0] * second[1] - second[0] * r[1]) / determinant, (first[0] * r[1] - r[0] * first[1]) / determinant]
}

/// Derivatives of the hand-written inverse dynamics: of y (0), ẏ (1) or ÿ (2).
fn jacobian(state: [[f64; 2]; 3], by: usize) -> [[f64; 2]; 2] {
    let mut rows = [[0.0; 2]; 2];
    for j in 0..2 {
        let mut point = state.map(|part| part.map(Dual64::from_re));
        point[by][j] = point[by][j].derivative();
        let forces = inverse(point);
        for i in 0..2 {
            rows[i][j] = forces[i].eps;
        }
    }
    rows
}

struct State {
    y: [f64; 2],
    v: [f64; 2],
    a: [f64; 2],
    u: [f64; 2],
}

/// States with all signs of loads and speeds; `seen` counts them.
fn states() -> Vec<State> {
    let mut rng = Rng::with_seed(11);
    let mut pair = |most: f64| [most * (2.0 * rng.f64() - 1.0), most * (2.0 * rng.f64() - 1.0)];
    let states: Vec<State> =
        (0..300).map(|_| State { y: pair(2.5), v: pair(0.3), a: pair(6.0), u: pair(0.4) }).collect();
    for joint in 0..2 {
        for (speed, load) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let count = states
                .iter()
                .filter(|s| s.v[joint] * speed > 0.0 && loads([s.y, s.v, s.a])[joint] * load > 0.0);
            assert!(count.count() > 30, "joint {joint}: speed {speed}, load {load}");
        }
    }
    states
}

fn arm() -> Robot {
    Robot::derive(&workspace().join("models/geared_arm.toml"), &GenerateOptions::default())
}

#[track_caller]
fn close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let size = expected.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * size, "{found} is not {expected}");
    }
}

#[test]
fn forces_and_accelerations_are_those_written_down() {
    for State { y, v, a, u } in states() {
        let found = Arm.inverse_dynamics(&y, &v, &a);
        close(&found, &inverse([y, v, a]), 1e-12);
        close(&Arm.load_friction(&y, &v), &shares(y, v), 1e-15);
        close(&Arm.friction_torques(&y, &v), &friction(v), 1e-14);
        let accelerations = Arm.forward_dynamics(&y, &v, &u);
        close(&accelerations, &forward(y, v, u), 1e-10);
        // Either way around.
        let back = Arm.inverse_dynamics(&y, &v, &accelerations);
        close(&back, &[GEARS[0] * u[0], GEARS[1] * u[1]], 1e-12);
        let inputs = [found[0] / GEARS[0], found[1] / GEARS[1]];
        close(&Arm.forward_dynamics(&y, &v, &inputs), &a, 1e-12);
    }
}

/// Defaults of the traits from M, k and q if a module lacks the other functions.
#[test]
fn the_traits_know_loads_without_the_module() {
    for State { y, v, a, u } in states() {
        let forces = gelenk_runtime::dynamics::defaults::inverse_dynamics(&Arm, &y, &v, &a);
        close(&forces, &inverse([y, v, a]), 1e-12);
        let accelerations = gelenk_runtime::dynamics::defaults::forward_dynamics(&Arm, &y, &v, &u);
        close(&accelerations, &forward(y, v, u), 1e-10);
    }
}

#[test]
fn jacobians_are_those_of_dual_numbers() {
    for State { y, v, a, u } in states() {
        let found = Arm.inverse_dynamics_derivatives(&y, &v, &a);
        close(&found.forces, &inverse([y, v, a]), 1e-12);
        close(&found.by_coordinates.concat(), &jacobian([y, v, a], 0).concat(), 1e-12);
        close(&found.by_velocities.concat(), &jacobian([y, v, a], 1).concat(), 1e-12);

        // ∂ÿ/∂x = −(∂f/∂ÿ)⁻¹ ∂f/∂x of the forces f at the accelerations that u causes.
        let linear = Arm.linearize(&y, &v, &u);
        let accelerations = forward(y, v, u);
        let at = [y, v, accelerations];
        let [[a, b], [c, d]] = jacobian(at, 2);
        let inverse = [[d, -b], [-c, a]].map(|row| row.map(|x| x / (a * d - b * c)));
        let times = |m: [[f64; 2]; 2]| -> Vec<f64> {
            let entry = |i: usize, j: usize| inverse[i][0] * m[0][j] + inverse[i][1] * m[1][j];
            vec![entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1)]
        };
        let by = |part: usize| times(jacobian(at, part).map(|row| row.map(|x| -x)));
        close(&linear.by_coordinates.concat(), &by(0), 1e-9);
        close(&linear.by_velocities.concat(), &by(1), 1e-9);
        close(&linear.by_inputs.concat(), &times([[GEARS[0], 0.0], [0.0, GEARS[1]]]), 1e-9);
        let known: Vec<f64> = (0..2)
            .map(|i| {
                let row = |m: &[[f64; 2]; 2], x: [f64; 2]| m[i][0] * x[0] + m[i][1] * x[1];
                row(&linear.by_coordinates, y)
                    + row(&linear.by_velocities, v)
                    + row(&linear.by_inputs, u)
                    + linear.affine[i]
            })
            .collect();
        close(&known, &accelerations, 1e-9);
    }
}

/// Over a sample time all follows from these.
#[test]
fn a_step_follows() {
    let period = 0.01;
    for State { y, v, u, .. } in states().into_iter().take(30) {
        let step = Arm.step_derivatives(&y, &v, &u, period);
        let (after, speed) = Arm.step(&y, &v, &u, period);
        close(&step.coordinates, &after, 1e-15);
        // Runge and Kutta's method over the accelerations written down.
        let x = [y, v];
        let rate = |x: [[f64; 2]; 2]| [x[1], forward(x[0], x[1], u)];
        let along = |x: [[f64; 2]; 2], d: [[f64; 2]; 2], h: f64| -> [[f64; 2]; 2] {
            std::array::from_fn(|k| std::array::from_fn(|i| x[k][i] + h * d[k][i]))
        };
        let k1 = rate(x);
        let k2 = rate(along(x, k1, 0.5 * period));
        let k3 = rate(along(x, k2, 0.5 * period));
        let k4 = rate(along(x, k3, period));
        let sum = along(along(along(k1, k2, 2.0), k3, 2.0), k4, 1.0);
        let [expected, expected_speed] = along(x, sum, period / 6.0);
        close(&after, &expected, 1e-12);
        close(&speed, &expected_speed, 1e-12);
        let linear = Arm.linearize(&y, &v, &u);
        let discrete = Arm.discretize(&y, &v, &u, period);
        assert_eq!(discrete, linear.discretize(period));
    }
}

/// Where the load vanishes, the derivatives are those without friction under load, and inverse to each other; on
/// either side they are as steep as its gear is stiff.
#[test]
fn at_the_kink_the_derivatives_are_those_without_load() {
    let robot = pendulum("friction = { load = \"0.2*tanh(20*v)\" }", ReadOptions::default());
    let (v, share) = (0.3, 0.2 * 6.0_f64.tanh());
    for (side, gain) in [(0.0, 1.0), (1e-9, 1.0 + share), (-1e-9, 1.0 - share)] {
        let inverse = robot.call("inverse_dynamics_derivatives", &[&[0.0], &[v], &[side]]);
        close(&inverse[1], &[gain * G], 1e-12);
        let linear = robot.call("linearize", &[&[0.0], &[v], &[side]]);
        close(&linear[2], &[50.0 / (0.6 * gain)], 1e-12);
        close(&linear[0], &[-G / 0.6], 1e-12);
    }
}

/// Whatever the load, a law that is odd adds nothing at rest.
#[test]
fn at_rest_nothing_is_added() {
    for State { y, a, .. } in states() {
        let still = [0.0; 2];
        close(&Arm.inverse_dynamics(&y, &still, &a), &loads([y, still, a]), 1e-13);
        assert_eq!(Arm.load_friction(&y, &still), still);
    }
}

#[test]
fn functions_whose_results_would_be_taken_for_derivatives_are_refused() {
    let robot = arm();
    for name in [
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives_and_mass_matrix",
        "inverse_dynamics_hessian",
    ] {
        assert!(robot.functions().iter().all(|function| function.name != name), "{name}");
        let problems = derive_functions(&robot.model, &[name.to_owned()], MOST_OPERATIONS).expect_err(name);
        let text = problems.to_string();
        assert!(
            text.contains("error[load-friction]") && text.contains(&format!("no function `{name}`")),
            "{text}"
        );
    }
}

/// Loops over joints know nothing of loads: straight-line code takes their place.
#[test]
fn there_are_no_loops() {
    let robot = Robot::in_form(arm().model, &["inverse_dynamics_derivatives", "linearize"], Form::Arrays);
    assert!(robot.functions().iter().all(|function| function.arrays.is_none()));
    let State { y, v, a, .. } = &states()[0];
    let found = robot.call("inverse_dynamics_derivatives", &[y, v, a]);
    close(&found[0], &inverse([*y, *v, *a]), 1e-12);
}

/// A description of one joint with these lines, and a function's first result.
fn pendulum(lines: &str, reading: ReadOptions) -> Robot {
    let text = format!(
        "[[joints]]\nname = \"swing\"\naxis = [0, 1, 0]\ndrive = {{ gear_ratio = 50 }}\n{lines}\n\
         [[bodies]]\nlink = \"swing\"\nmass = 2\ncenter_of_mass = [0, 0, -0.5]\ninertia = 0.1\n"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("pendulum.toml");
    std::fs::write(&path, text).expect("a file");
    Robot::derive(&path, &GenerateOptions { reading, ..GenerateOptions::default() })
}

/// One joint by hand: 0.6 kg m² and a load of 2 g 0.5 sin y.
#[test]
fn a_pendulum_feels_its_weight_in_its_gear() {
    let law = "friction = { coulomb = 0.4, load = [[\"sign(v)\", { free = 0.2, name = \"mu\" }], [\"abs(sign(v))\", 0.05]] }";
    let robot = pendulum(law, ReadOptions::default());
    for (y, v, a) in
        [(0.7_f64, 0.5, 1.0), (0.7, -0.5, 1.0), (-0.7, 0.5, 1.0), (-0.7, -0.5, -3.0), (0.7, 0.0, 0.0)]
    {
        let sign = if v == 0.0 { 0.0 } else { f64::signum(v) };
        let load = 0.6 * a + G * y.sin();
        for mu in [0.2, 0.5] {
            let expected = load + 0.4 * sign + load.abs() * (mu * sign + 0.05 * sign.abs());
            let found = robot.call_with("inverse_dynamics", &[&[y], &[v], &[a]], &[mu]);
            close(&found[0], &[expected], 1e-14);
            let back = robot.call_with("forward_dynamics", &[&[y], &[v], &[expected / 50.0]], &[mu]);
            close(&back[0], &[a], 1e-13);
        }
    }
    let smooth = pendulum(law, ReadOptions { smooth_sign: Some(100.0), ..ReadOptions::default() });
    let tanh = 0.5_f64.tanh();
    let found = smooth.first("load_friction", &[&[0.3], &[0.005]]);
    close(&found, &[0.2 * tanh + 0.05 * tanh * tanh], 1e-14);
    let none = pendulum(law, ReadOptions { no_friction: true, ..ReadOptions::default() });
    assert!(none.functions().iter().all(|function| function.name != "load_friction"));
    close(&none.first("inverse_dynamics", &[&[0.7], &[0.5], &[1.0]]), &[0.6 + G * 0.7_f64.sin()], 1e-14);
}

//! `discretize`, `step` and `step_derivatives` of every generated robot, against methods that share nothing
//! with them.

#![allow(clippy::expect_used, reason = "what is missing ends the test")]

mod emitted_code;
mod exponential;
mod integrator;
mod sensitivities;

mod zero_order_hold;

use fastrand::Rng;
use gelenk_runtime::dynamics::Dynamics;
use gelenk_tests::workspace;

/// One type per robot.
mod robots {
    gelenk_runtime::dynamics!(pub struct BalancedArm = gelenk_test_robots::balanced_arm);
    gelenk_runtime::dynamics!(pub struct CartPole = gelenk_test_robots::cart_pole);
    gelenk_runtime::dynamics!(pub struct DifferentialWrist = gelenk_test_robots::differential_wrist);
    gelenk_runtime::dynamics!(pub struct Excavator = gelenk_test_robots::excavator);
    gelenk_runtime::dynamics!(pub struct DoublePendulum { parameters } = gelenk_test_robots::double_pendulum);
    gelenk_runtime::dynamics!(pub struct GearedArm = gelenk_test_robots::geared_arm);
    gelenk_runtime::dynamics!(pub struct Gripper = gelenk_test_robots::gripper);
    gelenk_runtime::dynamics!(pub struct Palletizer = gelenk_test_robots::palletizer);
    gelenk_runtime::dynamics!(pub struct Panda = gelenk_test_robots::panda);
    gelenk_runtime::dynamics!(pub struct PowerCube = gelenk_test_robots::powercube);
    gelenk_runtime::dynamics!(pub struct PowerCubeAlpha = gelenk_test_robots::powercube_alpha);
    gelenk_runtime::dynamics!(pub struct FreePowerCubeAlpha { parameters } = gelenk_test_robots::powercube_alpha_parameters);
    gelenk_runtime::dynamics!(pub struct FreePowerCube { parameters } = gelenk_test_robots::powercube_parameters);
    gelenk_runtime::dynamics!(pub struct PowerCubeSixAxis = gelenk_test_robots::powercube_six_axis);
    gelenk_runtime::dynamics!(pub struct Puma560 = gelenk_test_robots::puma560);
    gelenk_runtime::dynamics!(pub struct Scara = gelenk_test_robots::scara);
    gelenk_runtime::dynamics!(pub struct SchunkLwa4p = gelenk_test_robots::schunk_lwa4p);
    gelenk_runtime::dynamics!(pub struct TwoArm = gelenk_test_robots::two_arm);
    gelenk_runtime::dynamics!(pub struct Tx40Like = gelenk_test_robots::tx40_like);
    gelenk_runtime::dynamics!(pub struct Ur5 = gelenk_test_robots::ur5);
}

/// Calls a generic function for each robot, with its name.
macro_rules! for_each_robot {
    ($check:path) => {
        $check("balanced_arm", &robots::BalancedArm);
        $check("cart_pole", &robots::CartPole);
        $check("differential_wrist", &robots::DifferentialWrist);
        $check("double_pendulum", &robots::DoublePendulum::default());
        $check("excavator", &robots::Excavator);
        $check("geared_arm", &robots::GearedArm);
        $check("gripper", &robots::Gripper);
        $check("palletizer", &robots::Palletizer);
        $check("panda", &robots::Panda);
        $check("powercube", &robots::PowerCube);
        $check("powercube_alpha", &robots::PowerCubeAlpha);
        $check("powercube_alpha_parameters", &robots::FreePowerCubeAlpha::default());
        $check("powercube_parameters", &robots::FreePowerCube::default());
        $check("powercube_six_axis", &robots::PowerCubeSixAxis);
        $check("puma560", &robots::Puma560);
        $check("scara", &robots::Scara);
        $check("schunk_lwa4p", &robots::SchunkLwa4p);
        $check("two_arm", &robots::TwoArm);
        $check("tx40_like", &robots::Tx40Like);
        $check("ur5", &robots::Ur5);
    };
}
use for_each_robot;

/// A state and inputs: coordinates up to 2, speeds from 0.3 to 1, away from the jumps of `sign`.
fn random_state<const N: usize, const M: usize>(rng: &mut Rng) -> ([f64; N], [f64; N], [f64; M]) {
    let mut signed = |low: f64, high: f64| {
        let size = low + (high - low) * rng.f64();
        if rng.bool() { size } else { -size }
    };
    let y = core::array::from_fn(|_| signed(0.0, 2.0));
    let v = core::array::from_fn(|_| signed(0.3, 1.0));
    (y, v, core::array::from_fn(|_| signed(0.0, 0.2)))
}

/// A random state of a robot whose loads, where friction grows with them, are so large that no input nearby turns
/// their sign: accelerations have a kink there.
fn smooth_state<const N: usize, const M: usize>(
    robot: &impl Dynamics<N, M>,
    rng: &mut Rng,
) -> ([f64; N], [f64; N], [f64; M]) {
    const FAR: f64 = 8.0;
    let input_matrix = robot.drive_matrix();
    loop {
        let (y, v, u) = random_state::<N, M>(rng);
        let (share, friction) = (robot.load_friction(&y, &v), robot.friction_torques(&y, &v));
        let exerted =
            |i: usize| input_matrix[i].iter().zip(&u).map(|(b, u)| b * u).sum::<f64>() - friction[i];
        if (0..N).all(|i| share[i] == 0.0 || exerted(i).abs() > FAR) {
            return (y, v, u);
        }
    }
}

/// Derivatives of a step as one matrix, rows (y⁺, ẏ⁺), columns (y, ẏ, u).
fn rows<const N: usize, const M: usize>(
    state: &[[[[f64; N]; N]; 2]; 2],
    input: &[[[f64; M]; N]; 2],
) -> Vec<Vec<f64>> {
    let half = |half: usize| {
        let row = move |i: usize| {
            let [by_y, by_v] = &state[half];
            [&by_y[i][..], &by_v[i], &input[half][i]].concat()
        };
        (0..N).map(row)
    };
    half(0).chain(half(1)).collect()
}

#[test]
fn no_robot_is_forgotten() {
    // Without its line breaks, which the formatter moves.
    let text: String = include_str!("main.rs").split_whitespace().collect();
    for file in std::fs::read_dir(workspace().join("generated/src")).expect("generated/src") {
        let path = file.expect("a file").path();
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        let listed = text.contains(&format!("gelenk_test_robots::{name})"));
        let checked = text.contains(&format!("$check(\"{name}\""));
        // Positions that are not vectors: tests/motion_on_manifolds.rs. A driven joint: tests/driven_motion.rs.
        let is_elsewhere = ["go2", "quadrotor", "satellite", "rail_arm"].contains(&name);
        assert!(name == "lib" || is_elsewhere || (listed && checked), "{name}");
    }
}

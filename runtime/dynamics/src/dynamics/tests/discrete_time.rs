//! Compares the discrete-time functions of a linear robot with the exponential of its matrix.

use super::*;

/// Two masses on springs and dampers, `M ÿ = −K y − D ẏ + B u + f`. The robot is linear, so the zero-order hold and the
/// sensitivities of a step are exact.
mod masses {
    pub use super::super::cart_pole::{
        EFFORT_LIMITS, FRICTION_JUMPS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, PEAK_EFFORT_LIMITS,
        PEAK_INPUT_LIMITS, POSITION_LIMITS, VELOCITY_LIMITS,
    };
    pub const FUNCTIONS: [&str; 2] = ["inverse_dynamics_derivatives", "linearize"];
    pub const N: usize = 2;
    pub const M: usize = 1;
    pub const STIFFNESS: [[f64; N]; N] = [[3.0, -1.0], [-1.0, 2.0]];
    pub const DAMPING: [[f64; N]; N] = [[0.5, -0.25], [-0.125, 0.75]];

    pub fn mass_matrix(_: &[f64; N]) -> [[f64; N]; N] {
        [[1.0, 0.0], [0.0, 1.0]]
    }
    pub fn coriolis_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }
    pub fn gravity_forces(_: &[f64; N]) -> [f64; N] {
        [0.5, -0.25]
    }
    pub fn spring_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        [0, 1].map(|i| {
            -(STIFFNESS[i][0] * y[0] + STIFFNESS[i][1] * y[1] + DAMPING[i][0] * v[0] + DAMPING[i][1] * v[1])
        })
    }
    pub fn friction_torques(_: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }
    pub fn input_matrix() -> [[f64; M]; N] {
        [[1.0], [2.0]]
    }
    pub fn inverse_dynamics_derivatives(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; N],
    ) -> ([f64; N], [[f64; N]; N], [[f64; N]; N]) {
        ([0.0; N], STIFFNESS, DAMPING)
    }
    #[allow(clippy::type_complexity, reason = "as generated")]
    pub fn linearize(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
    ) -> ([[f64; N]; N], [[f64; N]; N], [[f64; M]; N], [f64; N]) {
        let negative = |a: [[f64; N]; N]| a.map(|row| row.map(|x| -x));
        let gravity = gravity_forces(&[0.0; N]);
        (negative(STIFFNESS), negative(DAMPING), input_matrix(), gravity)
    }
}

crate::dynamics!(struct Masses = masses: Differentiable + Discretizable);

/// The matrix of the robot, extended by rows for u and 1, and its exponential by nalgebra (Padé, Higham 2005).
fn lifted_exponential(period: f64) -> nalgebra::SMatrix<f64, 6, 6> {
    let mut lifted = nalgebra::SMatrix::<f64, 6, 6>::zeros();
    let (by_y, by_v, by_u, affine) = masses::linearize(&Y, &V, &[0.0]);
    for i in 0..2 {
        lifted[(i, 2 + i)] = 1.0;
        lifted[(2 + i, 4)] = by_u[i][0];
        lifted[(2 + i, 5)] = affine[i];
        for j in 0..2 {
            lifted[(2 + i, j)] = by_y[i][j];
            lifted[(2 + i, 2 + j)] = by_v[i][j];
        }
    }
    (lifted * period).exp()
}

#[test]
fn the_zero_order_hold_is_the_exponential_of_the_lifted_matrix() {
    for period in [0.0, 0.02, 1.0, 5.0] {
        let discrete = Masses.discretize(&Y, &V, &[0.0], period);
        let expected = lifted_exponential(period);
        for (row, (half, i)) in [(0, 0), (0, 1), (1, 0), (1, 1)].into_iter().enumerate() {
            let [by_y, by_v] = discrete.state[half];
            let entries = [
                by_y[i][0],
                by_y[i][1],
                by_v[i][0],
                by_v[i][1],
                discrete.input[half][i][0],
                discrete.affine[half][i],
            ];
            for (column, entry) in entries.into_iter().enumerate() {
                let difference = entry - expected[(row, column)];
                assert!(difference.abs() < 1e-14, "{period} s, ({row}, {column}): {difference}");
            }
        }
    }
}

/// For a linear robot, a step of length h is the Taylor polynomial of degree 4 of the exponential. The error is h⁵/120 ‖A‖⁵.
#[test]
fn a_step_of_a_linear_robot_is_its_exponential_to_order_four() {
    let (u, period) = ([1.5], 0.01);
    let discrete = Masses.discretize(&Y, &V, &u, period);
    let (coordinates, velocities) = discrete.step(&Y, &V, &u);
    let (y, v) = Masses.step(&Y, &V, &u, period);
    let step = Masses.step_derivatives(&Y, &V, &u, period);
    for i in 0..2 {
        assert!((y[i] - coordinates[i]).abs() < 1e-9);
        assert!((v[i] - velocities[i]).abs() < 1e-9);
        assert!((y[i] - step.coordinates[i]).abs() < 1e-15);
        assert!((v[i] - step.velocities[i]).abs() < 1e-15);
    }
    for (a, b) in step.state.iter().flatten().zip(discrete.state.iter().flatten()) {
        for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
            assert!((a - b).abs() < 1e-9, "{a} and {b}");
        }
    }
    for (a, b) in step.input.iter().flatten().zip(discrete.input.iter().flatten()) {
        assert!((a[0] - b[0]).abs() < 1e-9, "{a:?} and {b:?}");
    }
}

//! A robot by hand, with the face of a generated module, whose quaternion stands between other entries: a slide, a free
//! body on a ball joint with three torques, a pendulum. They do not touch each other; what counts is their order.

use gelenk_kernels::discrete_time;

pub const N: usize = 5;
pub const M: usize = 5;
pub const NY: usize = 6;
pub const JOINTS: usize = 3;
pub const JOINT_NAMES: [&str; JOINTS] = ["slide", "ball", "pendulum"];
pub const VELOCITY_NAMES: [&str; N] = ["slide", "ball wx", "ball wy", "ball wz", "pendulum"];
pub const POSITION_NAMES: [&str; NY] = ["slide", "ball qx", "ball qy", "ball qz", "ball qw", "pendulum"];
pub const JOINT_POSITIONS: [usize; JOINTS] = [1, 4, 1];
pub const INPUT_NAMES: [&str; M] = VELOCITY_NAMES;
const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
pub const POSITION_LIMITS: [[f64; 2]; N] = [[-1.0, 0.5], FREE, FREE, FREE, [-2.0, 2.0]];
pub const VELOCITY_LIMITS: [f64; N] = [2.0, 5.0, 5.0, 5.0, 5.0];
pub const EFFORT_LIMITS: [f64; N] = [20.0, 2.0, 2.0, 2.0, 10.0];
pub const PEAK_EFFORT_LIMITS: [f64; N] = EFFORT_LIMITS;
pub const FRICTION_JUMPS: [[usize; 2]; 0] = [];
pub const INPUT_LIMITS: [f64; M] = EFFORT_LIMITS;
pub const PEAK_INPUT_LIMITS: [f64; M] = EFFORT_LIMITS;
pub const SUBSTEPS: usize = 1;
pub const FUNCTIONS: [&str; 2] = ["inverse_dynamics_derivatives", "linearize"];

const MASSES: [f64; N] = [2.0, 0.2, 0.3, 0.4, 0.5];
/// m g l of the pendulum (N m), damping of all joints (N m s).
const WEIGHT: f64 = 4.0;
const DAMPING: f64 = 0.1;

type Matrix = [[f64; N]; N];

pub fn mass_matrix(_: &[f64; NY]) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { MASSES[i] } else { 0.0 }))
}

pub fn coriolis_forces(_: &[f64; NY], v: &[f64; N]) -> [f64; N] {
    let difference = |i: usize, j: usize| (MASSES[j] - MASSES[i]) * v[i] * v[j];
    [0.0, difference(2, 3), difference(3, 1), difference(1, 2), 0.0]
}

pub fn gravity_forces(y: &[f64; NY]) -> [f64; N] {
    [0.0, 0.0, 0.0, 0.0, -WEIGHT * y[5].sin()]
}

pub fn spring_forces(_: &[f64; NY], _: &[f64; N]) -> [f64; N] {
    [0.0; N]
}

pub fn friction_torques(v: &[f64; N]) -> [f64; N] {
    v.map(|v| DAMPING * v)
}

pub fn input_matrix() -> [[f64; M]; N] {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

pub fn forward_dynamics(y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
    let (gravity, coriolis, friction) = (gravity_forces(y), coriolis_forces(y, v), friction_torques(v));
    core::array::from_fn(|i| (gravity[i] - coriolis[i] - friction[i] + u[i]) / MASSES[i])
}

pub fn inverse_dynamics_derivatives(y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> ([f64; N], Matrix, Matrix) {
    let (gravity, coriolis, friction) = (gravity_forces(y), coriolis_forces(y, v), friction_torques(v));
    let forces = core::array::from_fn(|i| MASSES[i] * a[i] + coriolis[i] + friction[i] - gravity[i]);
    let (mut by_y, mut by_v) = ([[0.0; N]; N], [[0.0; N]; N]);
    by_y[4][4] = WEIGHT * y[5].cos();
    for (row, i, j) in [(1, 2, 3), (2, 3, 1), (3, 1, 2)] {
        let difference = MASSES[j] - MASSES[i];
        (by_v[row][i], by_v[row][j]) = (difference * v[j], difference * v[i]);
    }
    (0..N).for_each(|i| by_v[i][i] += DAMPING);
    (forces, by_y, by_v)
}

/// A_y, A_v, B_x, c, D.
pub fn linearize(
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
) -> (Matrix, Matrix, [[f64; M]; N], [f64; N], Matrix) {
    let (_, by_y, by_v) = inverse_dynamics_derivatives(y, v, &[0.0; N]);
    let divided = |matrix: Matrix, sign: f64| -> Matrix {
        core::array::from_fn(|i| matrix[i].map(|entry| sign * entry / MASSES[i]))
    };
    let (by_y, by_v, by_u) = (divided(by_y, -1.0), divided(by_v, -1.0), divided(input_matrix(), 1.0));
    let value = forward_dynamics(y, v, u);
    let remainder = core::array::from_fn(|i| {
        let of_v: f64 = (0..N).map(|j| by_v[i][j] * v[j]).sum();
        value[i] - of_v - u[i] / MASSES[i]
    });
    let [_, a, b, c, _] = *v;
    let mut drift = [[0.0; N]; N];
    (drift[1][2], drift[1][3]) = (c, -b);
    (drift[2][1], drift[2][3]) = (-c, a);
    (drift[3][1], drift[3][2]) = (b, -a);
    (by_y, by_v, by_u, remainder, drift)
}

pub fn step(y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> ([f64; NY], [f64; N]) {
    discrete_time::runge_kutta_on_manifold(&JOINT_POSITIONS, y, v, period, SUBSTEPS, |y, v| {
        forward_dynamics(y, v, u)
    })
}

pub fn step_derivatives(
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
    period: f64,
) -> discrete_time::SteppedOnManifold<N, M, NY> {
    discrete_time::runge_kutta_on_manifold_derivatives(&JOINT_POSITIONS, y, v, u, period, SUBSTEPS, |y, v| {
        let (by_y, by_v, by_u, remainder, _) = linearize(y, v, u);
        (by_y, by_v, by_u, remainder)
    })
}

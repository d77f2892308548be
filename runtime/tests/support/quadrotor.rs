//! A quadrotor by hand, with the face of a generated module: a floating body whose centre of mass is its origin, and
//! four propellers. `gelenk_runtime::dynamics!(struct Quadrotor = quadrotor)` makes it a type.

use gelenk_kernels::{discrete_time, manifold};

pub const N: usize = 6;
pub const M: usize = 4;
pub const NY: usize = 7;
pub const JOINTS: usize = 1;
pub const JOINT_NAMES: [&str; JOINTS] = ["base"];
pub const VELOCITY_NAMES: [&str; N] = ["base vx", "base vy", "base vz", "base wx", "base wy", "base wz"];
pub const POSITION_NAMES: [&str; NY] =
    ["base x", "base y", "base z", "base qx", "base qy", "base qz", "base qw"];
pub const JOINT_POSITIONS: [usize; JOINTS] = [7];
pub const INPUT_NAMES: [&str; M] = ["front right", "back left", "front left", "back right"];
pub const POSITION_LIMITS: [[f64; 2]; N] = [[f64::NEG_INFINITY, f64::INFINITY]; N];
pub const VELOCITY_LIMITS: [f64; N] = [f64::INFINITY; N];
pub const EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
pub const PEAK_EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
pub const FRICTION_JUMPS: [[usize; 2]; 0] = [];
pub const INPUT_LIMITS: [f64; M] = [8.0; M];
pub const PEAK_INPUT_LIMITS: [f64; M] = [8.0; M];
pub const INPUT_RANGES: [[f64; 2]; M] = [[0.0, 8.0]; M];
/// Propellers are inputs at frames.
pub const DRIVES: usize = 0;
pub const SUBSTEPS: usize = 1;
pub const FUNCTIONS: [&str; 2] = ["inverse_dynamics_derivatives", "linearize"];

pub const MASS: f64 = 1.515;
pub const INERTIA: [f64; 3] = [0.0291, 0.0298, 0.0552];
const GRAVITY: f64 = 9.81;
/// Where the propellers are (m), and which moment a unit of their thrust has about the vertical axis (m).
const PROPELLERS: [[f64; 3]; M] =
    [[0.13, -0.22, 0.016], [-0.13, 0.2, 0.016], [0.13, 0.22, -0.016], [-0.13, -0.2, -0.016]];

type Matrix = [[f64; N]; N];

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The matrix of `a × …`.
fn skew(a: [f64; 3]) -> [[f64; 3]; 3] {
    [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]
}

fn parts(v: &[f64; N]) -> [[f64; 3]; 2] {
    [[v[0], v[1], v[2]], [v[3], v[4], v[5]]]
}

fn masses() -> [f64; N] {
    [MASS, MASS, MASS, INERTIA[0], INERTIA[1], INERTIA[2]]
}

/// The weight in the body's axes.
fn weight(y: &[f64; NY]) -> [f64; 3] {
    let [_, _, _, x, y, z, w] = *y;
    let up = [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)];
    up.map(|up| -MASS * GRAVITY * up)
}

pub fn mass_matrix(_: &[f64; NY]) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { masses()[i] } else { 0.0 }))
}

pub fn coriolis_forces(_: &[f64; NY], v: &[f64; N]) -> [f64; N] {
    let [l, w] = parts(v);
    let momentum = core::array::from_fn(|i| INERTIA[i] * w[i]);
    let (linear, angular) = (cross(w, l), cross(w, momentum));
    [MASS * linear[0], MASS * linear[1], MASS * linear[2], angular[0], angular[1], angular[2]]
}

pub fn gravity_forces(y: &[f64; NY]) -> [f64; N] {
    let [x, y, z] = weight(y);
    [x, y, z, 0.0, 0.0, 0.0]
}

pub fn spring_forces(_: &[f64; NY], _: &[f64; N]) -> [f64; N] {
    [0.0; N]
}

pub fn friction_torques(_: &[f64; N]) -> [f64; N] {
    [0.0; N]
}

pub fn input_matrix(_: &[f64; NY]) -> [[f64; M]; N] {
    let mut matrix = [[0.0; M]; N];
    for (j, [x, y, drag]) in PROPELLERS.into_iter().enumerate() {
        (matrix[2][j], matrix[3][j], matrix[4][j], matrix[5][j]) = (1.0, y, -x, drag);
    }
    matrix
}

pub fn forward_dynamics(y: &[f64; NY], v: &[f64; N], u: &[f64; M]) -> [f64; N] {
    let (gravity, coriolis, inputs) = (gravity_forces(y), coriolis_forces(y, v), input_matrix(y));
    core::array::from_fn(|i| {
        let input: f64 = (0..M).map(|j| inputs[i][j] * u[j]).sum();
        (gravity[i] - coriolis[i] + input) / masses()[i]
    })
}

pub fn inverse_dynamics_derivatives(y: &[f64; NY], v: &[f64; N], a: &[f64; N]) -> ([f64; N], Matrix, Matrix) {
    let (gravity, coriolis) = (gravity_forces(y), coriolis_forces(y, v));
    let forces = core::array::from_fn(|i| masses()[i] * a[i] + coriolis[i] - gravity[i]);
    let [l, w] = parts(v);
    let (by_turn, linear, angular) = (skew(weight(y)), skew(l), skew(w));
    let momentum = skew(core::array::from_fn(|i| INERTIA[i] * w[i]));
    let (mut by_y, mut by_v) = ([[0.0; N]; N], [[0.0; N]; N]);
    for i in 0..3 {
        for j in 0..3 {
            by_y[i][j + 3] = -by_turn[i][j];
            by_v[i][j] = MASS * angular[i][j];
            by_v[i][j + 3] = -MASS * linear[i][j];
            by_v[i + 3][j + 3] = angular[i][j] * INERTIA[j] - momentum[i][j];
        }
    }
    (forces, by_y, by_v)
}

/// A_y, A_v, B_x, c, D.
pub fn linearize(
    y: &[f64; NY],
    v: &[f64; N],
    u: &[f64; M],
) -> (Matrix, Matrix, [[f64; M]; N], [f64; N], Matrix) {
    let (_, by_y, by_v) = inverse_dynamics_derivatives(y, v, &[0.0; N]);
    let divided =
        |matrix: Matrix| -> Matrix { core::array::from_fn(|i| matrix[i].map(|entry| -entry / masses()[i])) };
    let (by_y, by_v) = (divided(by_y), divided(by_v));
    let inputs = input_matrix(y);
    let by_u: [[f64; M]; N] = core::array::from_fn(|i| inputs[i].map(|entry| entry / masses()[i]));
    let value = forward_dynamics(y, v, u);
    let remainder = core::array::from_fn(|i| {
        let of_v: f64 = (0..N).map(|j| by_v[i][j] * v[j]).sum();
        let of_u: f64 = (0..M).map(|j| by_u[i][j] * u[j]).sum();
        value[i] - of_v - of_u
    });
    let mut drift = [[0.0; N]; N];
    for j in 0..N {
        let mut unit = [0.0; N];
        unit[j] = -1.0;
        let column = manifold::bracket(&JOINT_POSITIONS, v, &unit);
        (0..N).for_each(|i| drift[i][j] = column[i]);
    }
    (by_y, by_v, by_u, remainder, drift)
}

pub fn discretize(y: &[f64; NY], v: &[f64; N], u: &[f64; M], period: f64) -> discrete_time::Discrete<N, M> {
    discrete_time::zero_order_hold_on_manifold(&linearize(y, v, u), period)
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

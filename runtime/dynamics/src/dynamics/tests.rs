use super::solve::{product, solve_positive_definite};
use super::*;

mod discrete_time;
mod lanes;

/// Hand-written module of a cart-pole with unit masses and unit length, with an ideal force on the cart. The equations are those of
/// Barto, Sutton and Anderson 1983 without friction, for a point mass and the angle from upright.
mod cart_pole {
    pub const N: usize = 2;
    pub const M: usize = 1;
    pub const FUNCTIONS: [&str; 1] = ["mass_matrix"];
    pub const JOINT_NAMES: [&str; N] = ["cart", "pole, upright"];
    pub const INPUT_NAMES: [&str; M] = ["belt"];
    pub const POSITION_LIMITS: [[f64; 2]; N] = [[-1.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY]];
    pub const VELOCITY_LIMITS: [f64; N] = [f64::INFINITY; N];
    pub const EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
    pub const PEAK_EFFORT_LIMITS: [f64; N] = [f64::INFINITY; N];
    pub const INPUT_LIMITS: [f64; M] = [10.0];
    pub const PEAK_INPUT_LIMITS: [f64; M] = [20.0];
    pub const FRICTION_JUMPS: [[usize; 2]; 0] = [];

    pub fn mass_matrix(y: &[f64; N]) -> [[f64; N]; N] {
        [[2.0, y[1].cos()], [y[1].cos(), 1.0]]
    }
    pub fn coriolis_forces(y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        [-y[1].sin() * v[1] * v[1], 0.0]
    }
    pub fn gravity_forces(y: &[f64; N]) -> [f64; N] {
        [0.0, 9.81 * y[1].sin()]
    }
    pub fn spring_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [0.0; N]
    }
    pub fn friction_torques(v: &[f64; N]) -> [f64; N] {
        [0.5 * v[0], 0.0]
    }
    pub fn input_matrix() -> [[f64; M]; N] {
        [[1.0], [0.0]]
    }
}

/// A module with all functions of the trait. The functions here return impossible values, so that tests recognize them.
mod full {
    pub use super::cart_pole::*;

    pub fn applied_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [1.0; N]
    }
    pub fn bias_forces(_: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [2.0; N]
    }
    pub fn equations_of_motion(_: &[f64; N], _: &[f64; N]) -> ([[f64; N]; N], [f64; N], [f64; N]) {
        ([[3.0; N]; N], [3.0; N], [3.0; N])
    }
    pub fn inverse_dynamics(_: &[f64; N], _: &[f64; N], _: &[f64; N]) -> [f64; N] {
        [4.0; N]
    }
    pub fn forward_dynamics(_: &[f64; N], _: &[f64; N], _: &[f64; M]) -> [f64; N] {
        [5.0; N]
    }
    pub fn kinetic_energy(_: &[f64; N], _: &[f64; N]) -> f64 {
        6.0
    }
}

/// The cart-pole with a free friction coefficient.
mod free {
    pub use super::cart_pole::*;

    pub const FUNCTIONS: [&str; 2] = ["inverse_dynamics_derivatives", "linearize"];

    #[derive(Debug, Clone, Copy, PartialEq, Default)]
    pub struct Parameters {
        pub friction: f64,
    }
    pub fn mass_matrix(y: &[f64; N], _: &Parameters) -> [[f64; N]; N] {
        super::cart_pole::mass_matrix(y)
    }
    pub fn coriolis_forces(y: &[f64; N], v: &[f64; N], _: &Parameters) -> [f64; N] {
        super::cart_pole::coriolis_forces(y, v)
    }
    pub fn gravity_forces(y: &[f64; N], _: &Parameters) -> [f64; N] {
        super::cart_pole::gravity_forces(y)
    }
    pub fn spring_forces(y: &[f64; N], v: &[f64; N], _: &Parameters) -> [f64; N] {
        super::cart_pole::spring_forces(y, v)
    }
    pub fn friction_torques(v: &[f64; N], p: &Parameters) -> [f64; N] {
        [p.friction * v[0], 0.0]
    }
    pub fn input_matrix(_: &Parameters) -> [[f64; M]; N] {
        super::cart_pole::input_matrix()
    }
    pub fn inverse_dynamics_derivatives(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; N],
        _: &Parameters,
    ) -> ([f64; N], [[f64; N]; N], [[f64; N]; N]) {
        ([1.0; N], [[2.0; N]; N], [[3.0; N]; N])
    }
    #[allow(clippy::type_complexity, reason = "as generated")]
    pub fn linearize(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
        p: &Parameters,
    ) -> ([[f64; N]; N], [[f64; N]; N], [[f64; M]; N], [f64; N]) {
        ([[1.0; N]; N], [[2.0; N]; N], [[3.0; M]; N], [p.friction; N])
    }
    pub const SUBSTEPS: usize = 9;
    #[allow(clippy::type_complexity, reason = "as generated")]
    pub fn discretize(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
        period: f64,
        p: &Parameters,
    ) -> ([[[[f64; N]; N]; 2]; 2], [[[f64; M]; N]; 2], [[f64; N]; 2]) {
        ([[[[period; N]; N]; 2]; 2], [[[p.friction; M]; N]; 2], [[8.0; N]; 2])
    }
    pub fn step(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
        period: f64,
        p: &Parameters,
    ) -> ([f64; N], [f64; N]) {
        ([period; N], [p.friction; N])
    }
    #[allow(clippy::type_complexity, reason = "as generated")]
    pub fn step_derivatives(
        _: &[f64; N],
        _: &[f64; N],
        _: &[f64; M],
        period: f64,
        p: &Parameters,
    ) -> ([f64; N], [f64; N], [[[[f64; N]; N]; 2]; 2], [[[f64; M]; N]; 2]) {
        ([1.0; N], [2.0; N], [[[[period; N]; N]; 2]; 2], [[[p.friction; M]; N]; 2])
    }
}

crate::dynamics!(
    /// The robot under test.
    pub struct CartPole = cart_pole
);
crate::dynamics!(struct Free { parameters } = free: Differentiable + Discretizable);

crate::dynamics!(struct Full = full);

const Y: [f64; 2] = [0.1, 0.7];
const V: [f64; 2] = [-0.3, 1.1];

/// Published closed form of the accelerations, solved for θ̈ and ẍ.
fn published(force: f64) -> [f64; 2] {
    let (sin, cos) = Y[1].sin_cos();
    let pushed = force - 0.5 * V[0] + V[1] * V[1] * sin;
    let x = (pushed - 9.81 * sin * cos) / (2.0 - cos * cos);
    [x, 9.81 * sin - x * cos]
}

#[test]
fn accelerations_follow_the_published_closed_form() {
    let computed = CartPole.forward_dynamics(&Y, &V, &[4.0]);
    for (a, b) in computed.iter().zip(published(4.0)) {
        assert!((a - b).abs() < 1e-13, "{a} and {b}");
    }
}

#[test]
fn inverse_dynamics_gives_the_input_back() {
    let forces = CartPole.inverse_dynamics(&Y, &V, &published(4.0));
    assert!((forces[0] - 4.0).abs() < 1e-13 && forces[1].abs() < 1e-13, "{forces:?}");
}

#[test]
fn an_indefinite_mass_matrix_gives_nan() {
    let x = solve_positive_definite([[1.0, 2.0], [2.0, 1.0]], [1.0, 1.0]);
    assert!(x.iter().all(|x| x.is_nan()));
}

#[test]
fn a_system_of_three_is_solved() {
    // Moler matrix with α = −1. x was chosen, and b = A x was computed by hand.
    let a = [[1.0, -1.0, -1.0], [-1.0, 2.0, 0.0], [-1.0, 0.0, 3.0]];
    assert_eq!(solve_positive_definite(a, [-4.0, 3.0, 8.0]), [1.0, 2.0, 3.0]);
}

#[test]
fn parameters_and_blocks_are_passed_on() {
    let robot = Free { parameters: free::Parameters { friction: 7.0 } };
    assert_eq!(robot.friction_torques(&[0.0; 2], &[2.0, 0.0]), [14.0, 0.0]);
    assert_eq!(Free::default().friction_torques(&[0.0; 2], &[2.0, 0.0]), [0.0, 0.0]);
    let linear = robot.linearize(&Y, &V, &[0.0]);
    assert_eq!(linear.accelerations(&[1.0, 1.0], &[1.0, 1.0], &[1.0]), [2.0 + 4.0 + 3.0 + 7.0; 2]);
    assert_eq!(robot.inverse_dynamics_derivatives(&Y, &V, &V).by_velocities, [[3.0; 2]; 2]);
    assert_eq!(robot.limits().peak_input, [[-20.0, 20.0]]);
}

#[test]
fn what_a_module_has_is_called() {
    assert_eq!(Full.applied_forces(&Y, &V), [1.0; 2]);
    assert_eq!(Full.bias_forces(&Y, &V), [2.0; 2]);
    assert_eq!(Full.equations_of_motion(&Y, &V).0, [[3.0; 2]; 2]);
    assert_eq!(Full.inverse_dynamics(&Y, &V, &V), [4.0; 2]);
    assert_eq!(Full.forward_dynamics(&Y, &V, &[0.0]), [5.0; 2]);
    assert_eq!(Full.kinetic_energy(&Y, &V), 6.0);
}

#[test]
fn names_are_those_of_the_module() {
    assert_eq!(CartPole.joint_names(), ["cart", "pole, upright"]);
    assert_eq!(CartPole.input_names(), ["belt"]);
}

#[test]
fn generic_code_needs_only_the_trait() {
    fn power<const N: usize, const M: usize>(robot: &impl Dynamics<N, M>, y: &[f64; N], v: &[f64; N]) -> f64 {
        product(&robot.friction_torques(y, v), v)
    }
    assert_eq!(power(&CartPole, &[0.0; 2], &[2.0, 0.0]), 2.0);
}

/// Modules whose friction depends on the position, with and without free parameters.
mod toothed {
    pub use super::cart_pole::{
        EFFORT_LIMITS, FRICTION_JUMPS, FUNCTIONS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, M, N,
        PEAK_EFFORT_LIMITS, PEAK_INPUT_LIMITS, POSITION_LIMITS, VELOCITY_LIMITS, coriolis_forces,
        gravity_forces, input_matrix, mass_matrix, spring_forces,
    };
    pub fn friction_torques(y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|i| (1.0 + y[i]) * v[i])
    }
}
mod free_toothed {
    pub use super::free::{
        EFFORT_LIMITS, FRICTION_JUMPS, FUNCTIONS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, M, N,
        PEAK_EFFORT_LIMITS, PEAK_INPUT_LIMITS, POSITION_LIMITS, Parameters, VELOCITY_LIMITS, coriolis_forces,
        gravity_forces, input_matrix, mass_matrix, spring_forces,
    };
    pub fn friction_torques(y: &[f64; N], v: &[f64; N], p: &Parameters) -> [f64; N] {
        core::array::from_fn(|i| p.friction * (1.0 + y[i]) * v[i])
    }
}

crate::dynamics!(struct Toothed = toothed);
crate::dynamics!(struct FreeToothed { parameters } = free_toothed);

#[test]
fn friction_of_the_position_gets_the_position() {
    assert_eq!(Toothed.friction_torques(&[1.0, -0.5], &[2.0, 3.0]), [4.0, 1.5]);
    let robot = FreeToothed { parameters: free_toothed::Parameters { friction: 7.0 } };
    assert_eq!(robot.friction_torques(&[1.0, -0.5], &[2.0, 3.0]), [28.0, 10.5]);
}

#[test]
fn functions_of_discrete_time_are_passed_on() {
    let robot = Free { parameters: free::Parameters { friction: 7.0 } };
    let u = [0.0];
    let discrete = robot.discretize(&Y, &V, &u, 0.5);
    assert_eq!(discrete.state, [[[[0.5; 2]; 2]; 2]; 2]);
    assert_eq!((discrete.input, discrete.affine), ([[[7.0]; 2]; 2], [[8.0; 2]; 2]));
    assert_eq!(robot.step(&Y, &V, &u, 0.5), ([0.5; 2], [7.0; 2]));
    let step = robot.step_derivatives(&Y, &V, &u, 0.5);
    assert_eq!((step.coordinates, step.velocities), ([1.0; 2], [2.0; 2]));
    assert_eq!((step.state, step.input), (discrete.state, [[[7.0; 1]; 2]; 2]));
    assert_eq!(Free::SUBSTEPS, 9);
}

fn limits<const N: usize, const M: usize>(motors: [f64; M], efforts: [f64; N]) -> Limits<N, M> {
    Limits {
        position: [[f64::NEG_INFINITY, f64::INFINITY]; N],
        velocity: [f64::INFINITY; N],
        effort: efforts.map(|e| 0.5 * e),
        peak_effort: efforts,
        input: motors.map(|u| [-0.1 * u, 0.1 * u]),
        peak_input: motors.map(|u| [-u, u]),
        dependent: &[],
        torque_speed: &[],
    }
}

/// Returns the highest inputs. The lowest inputs must be their negatives.
fn upper<const M: usize>(ranges: [[f64; 2]; M]) -> [f64; M] {
    ranges.map(|[low, high]| {
        assert_eq!(low, -high);
        high
    })
}

/// A propeller pushes in one direction. The effort limit clamps the range.
#[test]
fn ranges_that_are_not_symmetric_stay_so() {
    let mut robot = limits([f64::INFINITY], [10.0]);
    robot.peak_input = [[-1.0, 8.0]];
    assert_eq!(robot.at_inputs(&[[0.0]]).peak, [[-1.0, 8.0]]);
    assert_eq!(robot.at_inputs(&[[2.0]]).peak, [[-1.0, 5.0]]);
    assert_eq!(robot.at_inputs(&[[20.0]]).peak, [[-0.5, 0.5]]);
}

/// An input is limited by the smaller of the limits of motor and joint, for each ratio and sign. A joint without an input limits no
/// input.
#[test]
fn inputs_keep_the_efforts_of_their_joints() {
    let gears = [[-100.0, 0.0], [0.0, 0.5], [0.0, 0.0]];
    let robot = limits([1.0, f64::INFINITY], [60.0, 10.0, 1e-3]);
    let inputs = robot.at_inputs(&gears);
    assert_eq!(inputs.peak, [[-0.6, 0.6], [-20.0, 20.0]]);
    assert_eq!(inputs.nominal, [[-0.1, 0.1], [-10.0, 10.0]]);
    let unlimited = limits([f64::INFINITY, 3.0], [f64::INFINITY; 3]);
    assert_eq!(upper(unlimited.at_inputs(&gears).peak), [f64::INFINITY, 3.0]);
    assert_eq!(Dynamics::input_limits(&Free::default()).peak, [[-20.0, 20.0]]);
}

/// The robot is a differential. Both motors turn the first joint, and their difference turns the second joint.
#[test]
fn inputs_that_share_a_joint_keep_its_effort_whatever_their_signs() {
    let differential = [[2.0, 2.0], [2.0, -2.0]];
    let of_joints = limits([f64::INFINITY; 2], [12.0, 8.0]);
    assert_eq!(upper(of_joints.at_inputs(&differential).peak), [2.0; 2]);
    // Weak motors are not limited, because together they stay below both efforts.
    let of_motors = limits([1.0, 0.5], [12.0, 8.0]);
    assert_eq!(upper(of_motors.at_inputs(&differential).peak), [1.0, 0.5]);
    // The first motor leaves less than half of the effort to the second motor. Together they use the whole effort.
    let mixed = limits([1.0, f64::INFINITY], [12.0, f64::INFINITY]);
    let [first, second] = upper(mixed.at_inputs(&differential).peak);
    assert!(first <= 1.0 && (2.0 * (first + second) - 12.0).abs() < 1e-14);
}

/// A module with dry friction at its first joint, and steep but smooth friction at its second.
mod dry {
    pub use super::cart_pole::FUNCTIONS;
    pub use super::cart_pole::{
        EFFORT_LIMITS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, M, N, PEAK_EFFORT_LIMITS, PEAK_INPUT_LIMITS,
        POSITION_LIMITS, VELOCITY_LIMITS, coriolis_forces, gravity_forces, input_matrix, mass_matrix,
        spring_forces,
    };
    pub const FRICTION_JUMPS: [[usize; 2]; 1] = [[0, 0]];

    pub fn friction_torques(y: &[f64; N], v: &[f64; N]) -> [f64; N] {
        let sign = if v[0] == 0.0 { 0.0 } else { v[0].signum() };
        [(3.0 + y[0]) * sign + v[0], 2.0 * (1e20 * v[1]).tanh()]
    }
}

crate::dynamics!(struct Dry = dry);

/// Only the friction with `sign` is discontinuous at rest, and not the steep smooth friction.
#[test]
fn friction_jumps_where_it_is_dry() {
    let at_rest = Dry.friction_at_rest(&[0.5, 0.0]);
    assert_eq!(at_rest, [[-3.5, 3.5], [0.0; 2]]);
    assert_eq!(at_rest.map(jumps), [true, false]);
    // At this position the jump is zero. The slope of friction does not count as a jump.
    assert_eq!(Dry.friction_at_rest(&[-3.0, 0.0]), [[0.0; 2]; 2]);
}

/// Tests every corner of the input limits for matrices without structure.
#[test]
fn no_corner_of_the_input_limits_exceeds_an_effort() {
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    };
    for _ in 0..500 {
        let matrix: [[f64; 3]; 4] = core::array::from_fn(|_| {
            core::array::from_fn(|_| if uniform() < 0.4 { 0.0 } else { uniform() - 0.5 })
        });
        let motors = core::array::from_fn(|_| if uniform() < 0.5 { f64::INFINITY } else { uniform() });
        let efforts = core::array::from_fn(|_| if uniform() < 0.3 { f64::INFINITY } else { uniform() });
        let bounds = upper(limits(motors, efforts).at_inputs(&matrix).peak);
        for j in 0..3 {
            assert!(bounds[j] >= 0.0 && bounds[j] <= motors[j], "{bounds:?}");
        }
        for corner in 0..8 {
            let sign = |j: usize| if corner >> j & 1 == 0 { 1.0 } else { -1.0 };
            let u: [f64; 3] = core::array::from_fn(|j| sign(j) * bounds[j].min(1e9));
            for (row, effort) in matrix.iter().zip(efforts) {
                let made = product(row, &u).abs();
                assert!(made <= effort * (1.0 + 1e-14), "{matrix:?} {efforts:?} {bounds:?}");
            }
        }
    }
}

#[test]
fn limits_that_are_no_numbers_are_not_dropped() {
    let of = |motor, effort| limits([motor], [effort]).at_inputs(&[[2.0]]).peak[0];
    let are_nan = |[low, high]: [f64; 2]| low.is_nan() && high.is_nan();
    assert!(are_nan(of(f64::NAN, 1.0)) && are_nan(of(1.0, f64::NAN)));
}

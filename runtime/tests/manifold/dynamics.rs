//! The traits of a module with quaternions.

use super::{Quadrotor, quadrotor};
use gelenk_runtime::dynamics::{Differentiable, Discretizable, Dynamics, QuaternionJoint};

const Y: [f64; 7] = [0.3, -0.2, 1.0, 0.1, 0.5, -0.1, 0.8544003745317531];
const V: [f64; 6] = [0.4, -0.7, 0.2, 1.0, -2.0, 0.5];
const U: [f64; 4] = [3.0, 4.0, 3.5, 4.5];

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn methods_are_the_modules_functions() {
    assert_eq!(Quadrotor.forward_dynamics(&Y, &V, &U), quadrotor::forward_dynamics(&Y, &V, &U));
    assert_eq!(Quadrotor.step(&Y, &V, &U, 0.1), quadrotor::step(&Y, &V, &U, 0.1));
    let (_, _, state, input) = quadrotor::step_derivatives(&Y, &V, &U, 0.1);
    let step = Quadrotor.step_derivatives(&Y, &V, &U, 0.1);
    assert_eq!((step.state, step.input), (state, input));
    let (by_y, _, _, c, drift) = quadrotor::linearize(&Y, &V, &U);
    let linear = Quadrotor.linearize(&Y, &V, &U);
    assert_eq!((linear.by_coordinates, linear.affine, Quadrotor.drift(&V)), (by_y, c, drift));
    let (state, input, affine) = quadrotor::discretize(&Y, &V, &U, 0.02);
    let discrete = Quadrotor.discretize(&Y, &V, &U, 0.02);
    assert_eq!((discrete.state, discrete.input, discrete.affine), (state, input, affine));
    assert_eq!(linear.discretize_with(&drift, 0.02), discrete);
    assert_eq!(Quadrotor.joint_names(), quadrotor::VELOCITY_NAMES);
    assert_eq!(Quadrotor.position_names(), quadrotor::POSITION_NAMES);
    assert_eq!(Quadrotor.input_limits().peak, [[0.0, 8.0]; 4]);
}

/// The bodies of methods that the module lacks know that y is not v.
#[test]
fn other_methods_combine_these() {
    let a = Quadrotor.forward_dynamics(&Y, &V, &U);
    let forces = Quadrotor.inverse_dynamics(&Y, &V, &a);
    let inputs = Quadrotor.input_matrix(&Y);
    let expected: [f64; 6] = core::array::from_fn(|i| (0..4).map(|j| inputs[i][j] * U[j]).sum());
    assert!(distance(&forces, &expected) <= 1e-13, "{forces:?}");
    assert!(Quadrotor.kinetic_energy(&Y, &V) > 0.0);
    assert_eq!(Quadrotor.drive_matrix(), [[0.0; 4]; 6]);
}

#[test]
fn positions_move_on_the_manifold() {
    let next = Quadrotor.integrate(&Y, &V);
    assert!((next[3..].iter().map(|q| q * q).sum::<f64>() - 1.0).abs() <= 1e-15);
    assert!(distance(&Quadrotor.difference(&Y, &next), &V) <= 1e-14);
    assert_eq!(Quadrotor.neutral(), [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let (by_y, by_d) = Quadrotor.integrate_derivatives(&Y, &[0.0; 6]);
    let (by_to, _) = Quadrotor.difference_derivatives(&[0.0; 6]);
    assert_eq!((by_y, by_to), (by_d, by_y));
    let joint = QuaternionJoint { name: "base", position: 0, velocity: 0, is_floating: true };
    assert_eq!(Quadrotor.quaternion_joints(), [joint]);
    assert_eq!((joint.quaternion(), joint.angular_velocity()), (3, 3));
}

#[test]
fn quaternions_that_are_no_attitudes_name_their_joint() {
    assert_eq!(Quadrotor.check_attitudes(&Y), Ok(()));
    let with = |quaternion: [f64; 4]| {
        let mut y = Y;
        y[3..].copy_from_slice(&quaternion);
        Quadrotor.check_attitudes(&y).map_err(|error| error.to_string())
    };
    let message = |text: &str| Err(format!("the quaternion of joint base, {text}"));
    assert_eq!(with([0.0; 4]), message("x 0 y 0 z 0 w 0, is zero, so it is not an attitude"));
    assert_eq!(with([0.0, f64::NAN, 0.0, 1.0]), message("x 0 y NaN z 0 w 1, is not finite"));
    assert_eq!(
        with([0.0, 0.0, 0.0, 1.1]),
        message("x 0 y 0 z 0 w 1.1, has length 1.1; normalize it to length 1")
    );
    // A file with seven digits is precise enough.
    assert_eq!(with([0.6000001, 0.0, 0.0, 0.8]), Ok(()));
    let mut y = Y;
    y[3..].fill(0.0);
    assert!(!Quadrotor.normalize(&mut y) && y[6] == 1.0);
}

/// An arm has the same methods, which are sums and differences.
#[test]
fn arms_add_and_subtract() {
    gelenk_runtime::dynamics!(struct PowerCube = gelenk_generated::powercube);
    let robot = PowerCube;
    assert_eq!(robot.integrate(&[0.1, 0.2], &[0.3, 0.5]), [0.1 + 0.3, 0.2 + 0.5]);
    assert_eq!(robot.difference(&[0.1, 0.2], &[0.3, 0.5]), [0.3 - 0.1, 0.5 - 0.2]);
    assert_eq!(robot.bracket(&[1.0, 2.0], &[3.0, 4.0]), [0.0; 2]);
    assert_eq!(robot.drift(&[1.0, 2.0]), [[0.0; 2]; 2]);
    assert_eq!(robot.neutral(), [0.0; 2]);
    assert_eq!(robot.position_names(), robot.joint_names());
    assert!(robot.quaternion_joints().is_empty() && robot.check_attitudes(&[0.0; 2]).is_ok());
    let linear = robot.linearize(&[0.1, 0.2], &[0.0; 2], &[0.0; 2]);
    assert_eq!(linear.discretize(0.01), robot.discretize(&[0.1, 0.2], &[0.0; 2], &[0.0; 2], 0.01));
}

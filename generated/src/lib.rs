//! The robots of `models/` as generated Rust: plain functions on fixed-size arrays.
//!
//! `gelenk generate` writes this crate; `gelenk check` checks that it is up to date.
#![no_std]

/// The robot `balanced_arm`.
///
/// A planar arm of two links; a gas spring carries most of the weight at the shoulder.
///
/// y = 0 is upright. The gas spring pushes its ends apart, with a force that grows as it is pressed together. All numbers are estimated.
#[rustfmt::skip]
pub mod balanced_arm;

/// The robot `cart_pole`.
///
/// Inverted pendulum on a cart; the input is the force on the cart, the pole is passive.
#[rustfmt::skip]
pub mod cart_pole;

/// The robot `differential_wrist`.
///
/// An arm with two pitching joints and a wrist behind a differential gear.
///
/// The motors of the wrist sit side by side in the forearm. Where both turn alike the hand pitches, where they turn against each
/// other it rolls. All numbers are estimated.
#[rustfmt::skip]
pub mod differential_wrist;

/// The robot `double_pendulum`.
///
/// Planar double pendulum of two slender rods, hanging at y = 0.
#[rustfmt::skip]
pub mod double_pendulum;

/// The robot `excavator`.
///
/// A hydraulic excavator whose boom, stick and bucket are moved by cylinders.
///
/// The inputs are the swing motor's torque and the forces of the cylinders, positive where a cylinder pulls its ends together.
/// Cylinders have no mass here. All numbers are estimated.
#[rustfmt::skip]
pub mod excavator;

/// The robot `geared_arm`.
///
/// Planar arm of two links; the friction of its gears grows with what they transmit. y = 0 is upright.
#[rustfmt::skip]
pub mod geared_arm;

/// The robot `go2`.
///
/// Unitree Go2, with given wrenches at its feet.
///
/// Masses, lengths and limits are those of Unitree's description: package go2\_description of the repository unitree\_ros,
/// BSD-3-Clause. The rotors of its motors are bodies at rest. A leg turns about x at the hip, then about y at thigh and
/// calf; it hangs straight down at 0. FL is the front left leg. The wrenches are in the axes of the world.
#[rustfmt::skip]
pub mod go2;

/// The robot `gripper`.
///
/// A gripper with parallel fingers on a turning wrist.
///
/// One motor turns the left knuckle; the five other joints of the fingers follow it, so that the finger tips stay parallel. All
/// numbers are estimated.
#[rustfmt::skip]
pub mod gripper;

/// The robot `palletizer`.
///
/// A palletizing robot with a parallelogram.
///
/// Lower arm and crank turn on the turret. A rod parallel to the lower arm connects the crank with the forearm, which keeps the
/// crank's direction; the wrist stays level. The joints of rod, forearm and wrist follow those of lower arm and crank. All
/// numbers are estimated.
#[rustfmt::skip]
pub mod palletizer;

/// The robot `panda`.
///
/// Franka Emika Panda with ideal drives, its fingers held closed.
#[rustfmt::skip]
pub mod panda;

/// The robot `powercube`.
///
/// Schunk PowerCube arm reduced to the joints beta and gamma, all others held.
/// Both axes are parallel and horizontal; y = 0 is upright; gamma is measured relative to the first link.
#[rustfmt::skip]
pub mod powercube;

/// The robot `powercube_alpha`.
///
/// Schunk PowerCube arm reduced to the joint alpha, stretched out horizontally, all other joints held.
#[rustfmt::skip]
pub mod powercube_alpha;

/// The robot `powercube_alpha_parameters`.
///
/// Schunk PowerCube arm reduced to the joint alpha, stretched out horizontally, all other joints held, with friction as free
/// parameters. Defaults are the estimated values of powercube\_six\_axis.toml; they are not published.
#[rustfmt::skip]
pub mod powercube_alpha_parameters;

/// The robot `powercube_parameters`.
///
/// Schunk PowerCube arm reduced to the joints beta and gamma, all others held, with friction, gravity and the mass of a load as free parameters.
/// Both axes are parallel and horizontal; y = 0 is upright; gamma is measured relative to the first link.
/// Defaults are the published values, exact sign included.
#[rustfmt::skip]
pub mod powercube_parameters;

/// The robot `powercube_six_axis`.
///
/// Schunk PowerCube arm with six axes: alpha, beta, gamma (PR 90), delta (PR 70), epsilon, zeta (PW 70), gripper PG 70.
/// Values marked as estimated in the description are not published.
#[rustfmt::skip]
pub mod powercube_six_axis;

/// The robot `puma560`.
///
/// Unimation Puma 560, published data as collected by P. Corke.
#[rustfmt::skip]
pub mod puma560;

/// The robot `quadrotor`.
///
/// Quadrotor with the masses and the geometry of the 3DR Iris (PX4, sdf\_models). Its propellers are held:
/// each is a thrust along z with its drag moment about z. Thrust limits and the ratio of moment to thrust are
/// estimated.
#[rustfmt::skip]
pub mod quadrotor;

/// The robot `rail_arm`.
///
/// An arm of two links on a linear axis, which a controller of its own moves.
///
/// y = 0 is upright. The motion of the axis is given: position, velocity and acceleration are an argument. All numbers are
/// estimated.
#[rustfmt::skip]
pub mod rail_arm;

/// The robot `satellite`.
///
/// A satellite that turns by three reaction wheels, and a boom on a ball joint with a damper. All values are
/// estimated.
#[rustfmt::skip]
pub mod satellite;

/// The robot `scara`.
///
/// A SCARA with a screw-spline quill that carries a tapping unit.
///
/// Two nuts in the forearm move the quill: the spline nut turns it, and the screw nut lifts it by 20 mm for each turn against the
/// quill. The tap turns in a master thread of 1 mm, so that its feed is that of the thread it cuts. All numbers are estimated.
#[rustfmt::skip]
pub mod scara;

/// The robot `schunk_lwa4p`.
///
/// Schunk LWA 4P arm with six axes; y = 0 is stretched upwards.
#[rustfmt::skip]
pub mod schunk_lwa4p;

/// The robot `two_arm`.
///
/// A turning torso that carries two arms of three joints.
#[rustfmt::skip]
pub mod two_arm;

/// The robot `tx40_like`.
///
/// A six-axis arm like the Stäubli TX40: the motor of the last joint turns with joints 5 and 6 together.
///
/// y = 0 is upright. Motor 6 sits in front of joint 5, so that its shaft turns by 32 (y5 + y6), and its friction and its rotor act
/// on both joints. All masses, inertias and frictions are estimated.
#[rustfmt::skip]
pub mod tx40_like;

/// The robot `ur5`.
///
/// Universal Robots UR5 with ideal drives.
#[rustfmt::skip]
pub mod ur5;

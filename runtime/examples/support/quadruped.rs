//! Quadruped Go2 of `models/`: dimensions, standing pose, forces at the feet, and checks of limits.
#![allow(dead_code, reason = "no example needs all of it")]

use crate::outcome::Outcome;
use gelenk_generated::go2::{self as robot, M, N, NY, WRENCHES};
use nalgebra::{SMatrix, SVector};

/// Position of the front left hip in the frame of the trunk, along x and y [m].
pub const HIP: [f64; 2] = [0.1934, 0.0465];
/// Distance from a hip to the plane of its leg [m].
pub const ACROSS: f64 = 0.0955;
/// Length of a thigh, and of a calf [m].
pub const LENGTH: f64 = 0.213;
/// Coefficient of friction between feet and ground.
pub const FRICTION: f64 = 0.6;

/// Origin [m] and rotation matrix of a frame.
pub type Pose = ([f64; 3], [[f64; 3]; 3]);
pub type Jacobian = [[f64; N]; 6];
pub type Wrenches = [[f64; 6]; WRENCHES];

pub struct Foot {
    pub pose: fn(&[f64; NY]) -> Pose,
    pub jacobian: fn(&[f64; NY]) -> Jacobian,
    pub rate: fn(&[f64; NY], &[f64; N]) -> [f64; 6],
}

macro_rules! foot {
    ($pose:ident, $jacobian:ident, $rate:ident) => {
        Foot { pose: robot::$pose, jacobian: robot::$jacobian, rate: robot::$rate }
    };
}

/// Functions of the four feet, in the order of the legs' joints and of the wrenches.
pub const FEET: [Foot; 4] = [
    foot!(frame_fl_foot_pose, frame_fl_foot_jacobian, frame_fl_foot_jacobian_rate_times_velocity),
    foot!(frame_fr_foot_pose, frame_fr_foot_jacobian, frame_fr_foot_jacobian_rate_times_velocity),
    foot!(frame_rl_foot_pose, frame_rl_foot_jacobian, frame_rl_foot_jacobian_rate_times_velocity),
    foot!(frame_rr_foot_pose, frame_rr_foot_jacobian, frame_rr_foot_jacobian_rate_times_velocity),
];

/// Standing pose, with the feet at height 0 below the hips.
pub fn standing() -> [f64; NY] {
    let (mut y, bend) = (robot::NEUTRAL, 0.7_f64);
    y[2] = 2.0 * LENGTH * bend.cos();
    for leg in y[7..].chunks_exact_mut(3) {
        leg.copy_from_slice(&[0.0, bend, -2.0 * bend]);
    }
    y
}

/// Forces f at the feet that produce the six rows of the base, with the smallest sum of f²/w for the weights w. A foot with the
/// weight 0 has no force.
pub fn at_feet(rows: &[f64; N], jacobians: &[Jacobian; 4], weights: [f64; 4]) -> Outcome<Wrenches> {
    let g = SMatrix::<f64, 6, 12>::from_fn(|i, c| jacobians[c / 3][c % 3][i]);
    let weighed = SMatrix::<f64, 12, 6>::from_fn(|c, i| weights[c / 3] * g[(i, c)]);
    let rows = SVector::<f64, 6>::from_fn(|i, _| rows[i]);
    let forces = (g * weighed).cholesky().ok_or("the feet cannot carry the trunk")?.solve(&rows);
    let mut wrenches = [[0.0; 6]; WRENCHES];
    for (c, force) in (weighed * forces).iter().enumerate() {
        wrenches[c / 3][c % 3] = *force;
    }
    Ok(wrenches)
}

/// Ratio of the tangential force at a foot to the available friction; infinite if the foot would lift.
pub fn used_friction(force: &[f64; 6]) -> f64 {
    let along = force[0].hypot(force[1]);
    if force[2] > 0.0 { along / (FRICTION * force[2]) } else { f64::INFINITY }
}

/// Largest ratio of a joint torque to its limit.
pub fn used_torque(torques: &[f64; M]) -> f64 {
    let limits = &robot::EFFORT_LIMITS[N - M..];
    torques.iter().zip(limits).map(|(torque, limit)| torque.abs() / limit).fold(0.0, f64::max)
}

/// Checks the limits of all joints.
///
/// # Errors
/// An error if a joint exceeds its limits of position, velocity or torque.
pub fn within_limits(y: &[f64; NY], v: &[f64; N], torques: &[f64; M]) -> Outcome<()> {
    for (joint, torque) in torques.iter().enumerate() {
        let (i, name) = (N - M + joint, robot::JOINT_NAMES[1 + joint]);
        let [low, high] = robot::POSITION_LIMITS[i];
        let (fastest, strongest) = (robot::VELOCITY_LIMITS[i], robot::EFFORT_LIMITS[i]);
        let values = [
            ("position", "rad", y[NY - M + joint], low, high),
            ("velocity", "rad/s", v[i], -fastest, fastest),
            ("torque", "N m", *torque, -strongest, strongest),
        ];
        for (what, unit, value, low, high) in values {
            if !(low..=high).contains(&value) {
                return Err(
                    format!("the {what} of {name} is {value:.3} {unit}, not from {low} to {high}").into()
                );
            }
        }
    }
    Ok(())
}

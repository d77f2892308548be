//! The quadruped of `models/`: where its feet are, how it stands, and forces at its feet.
#![allow(dead_code, reason = "no example needs all of it")]

use crate::outcome::Outcome;
use gelenk_generated::quadruped::{self as robot, N, NY, WRENCHES};
use nalgebra::{SMatrix, SVector};

/// Origin and axes of a frame.
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

/// In the order of the legs' joints and of the wrenches.
pub const FEET: [Foot; 4] = [
    foot!(frame_front_left_pose, frame_front_left_jacobian, frame_front_left_jacobian_rate_times_velocity),
    foot!(frame_front_right_pose, frame_front_right_jacobian, frame_front_right_jacobian_rate_times_velocity),
    foot!(frame_rear_left_pose, frame_rear_left_jacobian, frame_rear_left_jacobian_rate_times_velocity),
    foot!(frame_rear_right_pose, frame_rear_right_jacobian, frame_rear_right_jacobian_rate_times_velocity),
];

/// Standing, the feet at height 0 below the hips.
pub fn standing() -> [f64; NY] {
    let (mut y, bend) = (robot::NEUTRAL, 0.7_f64);
    y[2] = 2.0 * 0.2 * bend.cos();
    for leg in y[7..].chunks_exact_mut(3) {
        leg.copy_from_slice(&[0.0, bend, -2.0 * bend]);
    }
    y
}

/// Forces at the feet that make the base's six rows, with the least sum of f²/w; a foot of weight 0 bears nothing.
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

//! Joints and motors whose motion is a weighted sum of coordinates and which have their own limits.

use super::{FollowedCoordinate, Model};
use gelenk_formula::Formula;

/// A joint that follows coordinates, or a motor with a speed limit whose drive acts on several coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Dependent<'m> {
    /// Name of the joint or of the drive.
    pub name: &'m str,
    /// Motion of the joint or motor per unit of motion of each coordinate, then of each joint with prescribed
    /// motion; `None` if a ratio depends on parameters without a given value.
    pub ratios: Option<Vec<f64>>,
    /// Position of the joint if all coordinates are 0 (rad or m); 0 for a motor.
    pub offset: f64,
    /// Lowest and highest position of the joint (rad or m); infinite without a limit.
    pub position: [f64; 2],
    /// Highest speed of the joint or motor (rad/s or m/s); infinite without a limit.
    pub velocity: f64,
}

const UNLIMITED: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

impl Model {
    /// Joints that follow coordinates, in order, then motors with a speed limit whose drives act on several
    /// coordinates.
    ///
    /// - `parameters`: values of the free parameters
    #[must_use]
    pub fn dependent(&self, parameters: &[f64]) -> Vec<Dependent<'_>> {
        let moving = self.moving_joints();
        let joints = moving[self.motion_count()..].iter().map(|follower| {
            let limits = &follower.joint.limits;
            Dependent {
                name: self.joint_of(follower.link).name.as_str(),
                ratios: self.row(&follower.follows, &Formula::ONE, parameters),
                offset: follower.offset,
                position: limits.position.unwrap_or(UNLIMITED),
                velocity: limits.velocity.unwrap_or(f64::INFINITY),
            }
        });
        let motors = self.limited_shafts().map(|(drive, speed)| Dependent {
            name: drive.name.as_str(),
            ratios: self.row(&drive.acts_on, &drive.gear_ratio, parameters),
            offset: 0.0,
            position: UNLIMITED,
            velocity: speed,
        });
        joints.chain(motors).collect()
    }

    /// Drives on several coordinates whose motors have a speed limit, with this limit (rad/s).
    pub fn limited_shafts(&self) -> impl Iterator<Item = (&super::Drive, f64)> {
        let shared = self.input_drives().filter(|drive| drive.acts_on.len() > 1);
        shared.filter_map(|drive| Some((drive, drive.speed?)))
    }

    /// Ratios of a joint or drive to all coordinates, each multiplied by `factor`; `None` if a ratio depends
    /// on parameters without a value.
    fn row(&self, follows: &[FollowedCoordinate], factor: &Formula, parameters: &[f64]) -> Option<Vec<f64>> {
        let mut row = vec![0.0; self.motion_count()];
        for term in follows {
            row[term.coordinate] += factor.value(parameters)? * term.ratio.value(parameters)?;
        }
        Some(row)
    }
}

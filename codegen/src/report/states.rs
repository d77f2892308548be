//! Seeded states within the limits of a robot.

use super::robot::Robot;
use crate::model::Actuator;
use crate::random::Random;

/// A state with accelerations and inputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    pub y: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub u: Vec<f64>,
    /// Position, velocity and acceleration of each driven joint.
    pub d: Vec<f64>,
}

impl State {
    /// The motion of the driven joints, without their velocities and accelerations where they rest.
    pub fn driven(&self, rest: bool) -> Vec<f64> {
        let moves = |place: usize| !rest || place.is_multiple_of(3);
        self.d.iter().enumerate().map(|(place, d)| if moves(place) { *d } else { 0.0 }).collect()
    }

    /// A state within the limits. No velocity is close to 0, where friction may jump.
    pub fn seeded(robot: &Robot<'_>, random: &mut Random) -> Self {
        let joints = robot.joints();
        let y = joints.iter().map(|joint| {
            let [low, high] = joint.seeded_range();
            random.between(low, high)
        });
        let y: Vec<f64> = y.collect();
        let y = robot.model.positions_by(&y);
        let v = joints.iter().map(|joint| {
            let most = joint.limits.velocity.unwrap_or(1.0).min(10.0);
            random.either_side(0.1 * most, most)
        });
        let v = v.collect();
        let a = joints.iter().map(|_| random.either_side(0.1, 2.0)).collect();
        let inputs = robot.inputs();
        let u = inputs.iter().map(|input| match input {
            Actuator::Drive(drive) => {
                let ratio = robot.value(&drive.gear_ratio).abs().max(1e-3);
                let most = drive.torque.nominal.unwrap_or(10.0 / ratio);
                random.either_side(0.1 * most, most)
            }
            Actuator::Force(force) => {
                let [low, high] = force.limits.unwrap_or([-10.0, 10.0]);
                random.between(low, high)
            }
        });
        let u = u.collect();
        let d = robot.model.driven_joints().flat_map(|joint| {
            let [low, high] = joint.seeded_range();
            [random.between(low, high), random.either_side(0.1, 1.0), random.either_side(0.1, 2.0)]
        });
        let d = d.collect();
        Self { y, v, a, u, d }
    }
}

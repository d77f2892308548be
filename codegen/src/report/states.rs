//! Seeded states within the limits of a robot.

use super::robot::Robot;
use crate::model::{Joint, JointKind};

/// SplitMix64 (Steele, Lea and Flood 2014): the same numbers on every platform.
#[derive(Debug, Clone)]
pub(super) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Evenly in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        // The upper 53 bits are a fraction that an f64 holds exactly.
        #[expect(clippy::cast_precision_loss, reason = "53 bits fit")]
        let fraction = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * fraction
    }

    /// Evenly in `±(low..high)`.
    fn either_side(&mut self, low: f64, high: f64) -> f64 {
        let size = self.between(low, high);
        if self.between(0.0, 1.0) < 0.5 {
            -size
        } else {
            size
        }
    }
}

/// A state with accelerations and inputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    pub y: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub u: Vec<f64>,
}

/// Range of positions of a joint without limits: a turn to each side, or half a metre.
const TURN: f64 = std::f64::consts::PI;
const SLIDE: f64 = 0.5;

impl State {
    /// A state within the limits. No velocity is close to 0, where friction may jump.
    pub fn seeded(robot: &Robot<'_>, random: &mut Random) -> Self {
        let joints = robot.joints();
        let y = joints.iter().map(|joint| {
            let [low, high] = positions(joint);
            random.between(low, high)
        });
        let y = y.collect();
        let v = joints.iter().map(|joint| {
            let most = joint.limits.velocity.unwrap_or(1.0).min(10.0);
            random.either_side(0.1 * most, most)
        });
        let v = v.collect();
        let a = joints
            .iter()
            .map(|_| random.either_side(0.1, 2.0))
            .collect();
        let inputs = robot.inputs();
        let u = inputs.iter().map(|drive| {
            let ratio = robot.value(&drive.gear_ratio).abs().max(1e-3);
            let most = drive.torque.nominal.unwrap_or(10.0 / ratio);
            random.either_side(0.1 * most, most)
        });
        let u = u.collect();
        Self { y, v, a, u }
    }
}

fn positions(joint: &Joint) -> [f64; 2] {
    let free = if joint.kind == JointKind::Prismatic {
        SLIDE
    } else {
        TURN
    };
    joint.limits.position.unwrap_or([-free, free])
}

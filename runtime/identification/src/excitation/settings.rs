//! Settings of a planned motion.

use super::super::error::{Result, require_setting};
use super::Excitation;
use std::f64::consts::PI;

/// Limits that a planned motion keeps, and settings of its search.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSettings {
    /// Settings of the search, with the period of the motion.
    pub excitation: Excitation,
    /// Usable share of the position range of each joint, centred at the middle of the range; above 0, at most 1.
    pub position_share: f64,
    /// Usable share of the described speeds; above 0, at most 1.
    pub velocity_share: f64,
    /// Usable share of the described efforts; above 0, at most 1. The described robot does not exceed it in the motion.
    pub effort_share: f64,
    /// Largest acceleration [rad/s² or m/s²]. If it is `None`, a joint may reach twice its usable speed in one second.
    pub acceleration: Option<f64>,
    /// Largest speed of joints without a described limit [rad/s or m/s].
    pub velocity: f64,
    /// Width of the position range of prismatic joints without described limits \[m\]: they move from −travel/2 to travel/2.
    /// Revolute joints without described limits move from −π to π. [`Self::position_share`] narrows both ranges.
    pub travel: f64,
    /// Largest rotation of joints with a quaternion from their zero position \[rad\], above 0 and below π. Descriptions have
    /// no such limit.
    pub turn: f64,
    /// Posture from which the robot moves to the beginning of the motion [rad or m], one entry for each joint. A joint with a
    /// quaternion has the coordinates of [`Approach`](super::Approach). `None` plans no approach.
    pub start: Option<Vec<f64>>,
}

impl Default for PlanSettings {
    fn default() -> Self {
        Self {
            excitation: Excitation {
                period: 20.0,
                harmonics: 8,
                samples: 100,
                starts: 3,
                iterations: 300,
                seed: 1,
            },
            position_share: 0.9,
            velocity_share: 0.7,
            effort_share: 0.7,
            acceleration: None,
            velocity: 1.0,
            travel: 0.2,
            turn: 1.0,
            start: None,
        }
    }
}

/// Fails if a share or a size is out of its range.
pub(super) fn check(settings: &PlanSettings) -> Result<()> {
    let shares = [
        ("position share", settings.position_share),
        ("velocity share", settings.velocity_share),
        ("effort share", settings.effort_share),
    ];
    for (name, share) in shares {
        require_setting(name, share, share > 0.0 && share <= 1.0, "it must be above 0 and at most 1")?;
    }
    for (name, value) in [("velocity", settings.velocity), ("travel", settings.travel)] {
        require_setting(name, value, value > 0.0 && value.is_finite(), "it must be positive and finite")?;
    }
    let turns = settings.turn > 0.0 && settings.turn < PI;
    require_setting("turn", settings.turn, turns, "it must be above 0 and below π")?;
    let acceleration = settings.acceleration.unwrap_or(1.0);
    require_setting("acceleration", acceleration, acceleration > 0.0, "it must be positive")
}

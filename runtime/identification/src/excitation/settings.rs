//! Settings of a plan.

use super::super::error::{Result, require_setting};
use super::Excitation;
use std::f64::consts::PI;

/// Limits of the robot that a plan keeps, and settings of its search.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanSettings {
    /// Search, and period of the motion (s).
    pub excitation: Excitation,
    /// Share of the range of positions that is used, about its middle.
    pub position_share: f64,
    /// Share of the described speeds that is used.
    pub velocity_share: f64,
    /// Share of the described efforts that the motion may need by the described robot.
    pub effort_share: f64,
    /// Largest acceleration [rad/s² or m/s²]; twice the largest speed per second if there is none.
    pub acceleration: Option<f64>,
    /// Largest speed [rad/s or m/s] of joints without a described one.
    pub velocity: f64,
    /// Range of positions \[m\] of prismatic joints without described ones; revolute ones may turn by ±π.
    pub travel: f64,
    /// Largest turn \[rad\] of joints with a quaternion from where they stand at 0, below π: they have no described one.
    pub turn: f64,
    /// Posture from which the robot goes to the beginning of the motion [rad or m], by joint; of a joint with a quaternion the
    /// place and the rotation vector.
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

/// Fails if a share or a size is out of range.
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

//! The motion from a given posture to the beginning of a planned motion.

use super::super::error::{Result, require_length, require_setting};
use super::super::robot::{Instant, Robot, narrowed_limits};
use super::ExcitationLimits;
use super::chart::Chart;
use std::f64::consts::PI;

/// Largest speed and acceleration of the minimum-jerk motion from 0 to 1 in one second.
const PEAKS: [f64; 2] = [1.875, 5.773_502_691_896_258];
/// Number of intervals of the motion at whose ends its forces are computed.
const PARTS: usize = 100;
/// Share of a range of positions by which a posture may lie outside the range, because postures are typed with a few digits.
const ROUNDING: f64 = 1e-6;

/// A straight motion between two postures, at rest without acceleration at both ends. It follows the minimum-jerk polynomial
/// `s(τ) = 10 τ³ − 15 τ⁴ + 6 τ⁵` for τ from 0 to 1 (Flash and Hogan 1985). All joints move at the same time.
#[derive(Debug, Clone, PartialEq)]
pub struct Approach {
    /// Posture at the beginning [rad or m], one entry for each joint. A joint with a quaternion has the three entries of the
    /// rotation vector of its orientation. If it is floating, the three entries of its origin's position come first.
    pub from: Vec<f64>,
    /// Posture at the end of the approach [rad or m], in the coordinates of `from`.
    pub to: Vec<f64>,
    /// Shortest time that keeps the limits of speed and acceleration \[s\]; 0 if both postures are equal.
    pub seconds: f64,
}

impl Approach {
    /// The fastest motion within the limits.
    pub(super) fn new(from: &[f64], to: &[f64], chart: &Chart, limits: &[ExcitationLimits]) -> Self {
        let seconds = |((from, to), limit): ((&f64, &f64), &ExcitationLimits)| {
            let way = (to - from).abs();
            (PEAKS[0] * way / limit.velocity).max((PEAKS[1] * way / limit.acceleration).sqrt())
        };
        let seconds = from.iter().zip(to).zip(limits).map(seconds).fold(0.0, f64::max);
        let mut approach = Self { from: from.to_vec(), to: to.to_vec(), seconds };
        // Bodies may rotate faster than their rotation vectors change. In f times the time, velocities are divided by f and
        // accelerations by f².
        let excess = chart.largest_excess(&chart.instants(&approach.instants()), limits);
        approach.seconds *= excess.max(1.0);
        approach
    }

    /// Position y, velocity ẏ and acceleration ÿ at a share τ of the approach, which takes `seconds`.
    fn instant(&self, share: f64, seconds: f64) -> Instant {
        let t = share.clamp(0.0, 1.0);
        let s = t * t * t * (10.0 - 15.0 * t + 6.0 * t * t);
        let ds = 30.0 * t * t * (1.0 - t).powi(2) / seconds;
        let dds = 60.0 * t * (1.0 - t) * (1.0 - 2.0 * t) / (seconds * seconds);
        let way = || self.from.iter().zip(&self.to);
        [
            way().map(|(from, to)| from + s * (to - from)).collect(),
            way().map(|(from, to)| ds * (to - from)).collect(),
            way().map(|(from, to)| dds * (to - from)).collect(),
        ]
    }

    /// States along the motion; empty if both postures are equal.
    pub(super) fn instants(&self) -> Vec<Instant> {
        let share = |i: usize| i as f64 / PARTS as f64;
        let moves = self.seconds > 0.0;
        (0..=PARTS).filter(|_| moves).map(|i| self.instant(share(i), self.seconds)).collect()
    }

    /// States of the approach with a period \[s\]. The last state is left out, because the planned motion begins with it. The
    /// approach takes a little longer than the shortest time, so that it lasts a whole number of periods.
    pub(super) fn rows(&self, period: f64) -> Vec<Instant> {
        let rows = (self.seconds / period - 1e-9).ceil().max(0.0) as usize;
        let seconds = rows as f64 * period;
        (0..rows).map(|row| self.instant(row as f64 / rows as f64, seconds)).collect()
    }
}

/// Fails if a posture is not possible for the robot.
///
/// # Errors
/// [`IdentificationError::Shape`](crate::error::IdentificationError::Shape) if the number of entries is wrong, and
/// [`IdentificationError::Setting`](crate::error::IdentificationError::Setting) for a rotation of π or more, or for a joint
/// beyond its described limits. Joints that follow other joints are checked, too.
pub(super) fn require_posture(robot: &dyn Robot, chart: &Chart, start: &[f64]) -> Result<()> {
    let names = robot.joint_names();
    require_length("positions of the start", names.len(), start.len())?;
    for (name, rows) in chart.rotations() {
        let turn = start[rows].iter().map(|x| x * x).sum::<f64>().sqrt();
        let requirement = "the length of its rotation vector must lie below π";
        require_setting(&format!("rotation of joint {name} at the start"), turn, turn < PI, requirement)?;
    }
    let own = narrowed_limits(robot).into_iter().zip(names).zip(start);
    let own = own.map(|((limits, name), y)| (name, limits.position, *y));
    let followers = robot.followers().into_iter();
    let followers = followers.map(|joint| {
        let y = joint.sum(start.iter().copied(), joint.offset);
        (joint.name, joint.position, y)
    });
    for (name, [low, high], y) in own.chain(followers) {
        let slack = if (high - low).is_finite() { ROUNDING * (high - low) } else { 0.0 };
        let requirement = format!("it must lie within its described limits, {low} to {high}");
        let is_within = low - slack <= y && y <= high + slack;
        require_setting(&format!("start of joint {name}"), y, is_within, &requirement)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_keeps_speed_and_acceleration_and_no_less_time_would() {
        let limits = |velocity: f64, acceleration: f64| ExcitationLimits {
            position: [-3.0, 3.0],
            velocity,
            acceleration,
        };
        let chart = Chart::plain(2);
        for limits in [[limits(1.0, 9.0), limits(0.5, 2.0)], [limits(2.0, 1.0), limits(9.0, 9.0)]] {
            let approach = Approach::new(&[0.5, -1.0], &[-0.7, 0.2], &chart, &limits);
            let rows = approach.rows(0.001);
            let mut shares: Vec<f64> = Vec::new();
            for (joint, limit) in limits.iter().enumerate() {
                let largest = |k: usize| rows.iter().map(|row| row[k][joint].abs()).fold(0.0, f64::max);
                shares.extend([largest(1) / limit.velocity, largest(2) / limit.acceleration]);
                // Differences of the positions are the speeds.
                for (i, pair) in rows.windows(2).enumerate() {
                    let slope = (pair[1][0][joint] - pair[0][0][joint]) / 0.001;
                    assert!((slope - 0.5 * (pair[0][1][joint] + pair[1][1][joint])).abs() < 1e-4, "{i}");
                }
                assert_eq!(rows[0][0][joint], approach.from[joint]);
                assert!((rows.last().unwrap()[0][joint] - approach.to[joint]).abs() < 1e-6);
            }
            let most = shares.into_iter().fold(0.0, f64::max);
            assert!((0.99..1.0 + 1e-9).contains(&most), "{most}");
        }
        let still = Approach::new(&[0.5], &[0.5], &chart, &[limits(1.0, 1.0)]);
        assert!(still.rows(0.01).is_empty());
    }
}

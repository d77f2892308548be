//! Reference of the control loop: computes the time at which the trajectory is evaluated, and slows this time down during
//! a controlled stop.

use crate::trajectory::{Sample, Trajectory};

/// Time s on the trajectory. The time follows the clock until a controlled stop begins at s_0. During the stop of
/// duration T_s, with the time t since its beginning, the time slows down to standstill:
///
/// ```text
///     s(t) = s_0 + t − t²/(2 T_s)        0 ≤ t ≤ T_s
///     y_d = y(s),  ẏ_d = y'(s) ṡ,  ÿ_d = y''(s) ṡ² + y'(s) s̈
/// ```
///
/// Therefore the robot remains on its path (Dahl, Nielsen, *Torque-limited path following by on-line
/// trajectory time scaling*, IEEE Trans. Robotics and Automation 6 (1990)).
#[derive(Debug, Clone, Copy)]
pub(super) enum Reference {
    /// The trajectory runs. `time` is the present time on the trajectory (s).
    Running { time: f64 },
    /// The trajectory stops from the time `since` (s) on. `elapsed` of `span` seconds have passed.
    Stopping { since: f64, elapsed: f64, span: f64 },
}

impl Reference {
    /// Starts a stop of `span` seconds.
    pub fn stop(&mut self, span: f64) {
        if let Self::Running { time } = *self {
            *self = Self::Stopping { since: time, elapsed: 0.0, span };
        }
    }

    /// Advances a stop by `step` seconds. If no stop has begun, sets the time to `time` (s).
    pub fn advance(&mut self, time: f64, step: f64) {
        match self {
            Self::Running { time: now } => *now = time,
            Self::Stopping { elapsed, .. } => *elapsed += step,
        }
    }

    /// Time on the trajectory (s).
    pub fn time(&self) -> f64 {
        match *self {
            Self::Running { time } => time,
            Self::Stopping { since, elapsed, span } => {
                let t = elapsed.min(span);
                // A stop with `span` = 0 is immediate. The condition avoids 0/0.
                since + if span > 0.0 { t - t * t / (2.0 * span) } else { 0.0 }
            }
        }
    }

    /// Time since the end of the stop (s); `None` before the end of a stop.
    pub fn standing(&self) -> Option<f64> {
        match *self {
            Self::Stopping { elapsed, span, .. } if elapsed >= span => Some(elapsed - span),
            _ => None,
        }
    }

    /// Desired positions, velocities and accelerations at the present time on the trajectory.
    pub fn sample<const N: usize, const NY: usize>(
        &self,
        trajectory: &impl Trajectory<N, NY>,
    ) -> Sample<N, NY> {
        let sample = trajectory.sample(self.time());
        let (rate, slope) = match *self {
            Self::Running { .. } => return sample,
            Self::Stopping { elapsed, span, .. } if elapsed < span => (1.0 - elapsed / span, -1.0 / span),
            Self::Stopping { .. } => (0.0, 0.0),
        };
        let (v, a) = (sample.velocities, sample.accelerations);
        Sample {
            positions: sample.positions,
            velocities: v.map(|v| v * rate),
            accelerations: core::array::from_fn(|i| a[i] * rate * rate + v[i] * slope),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = sin t, so that all derivatives differ.
    struct Sine;

    impl Trajectory<1> for Sine {
        fn duration(&self) -> f64 {
            100.0
        }

        fn sample(&self, t: f64) -> Sample<1> {
            Sample { positions: [t.sin()], velocities: [t.cos()], accelerations: [-t.sin()] }
        }
    }

    fn stopping(elapsed: f64) -> Reference {
        Reference::Stopping { since: 1.0, elapsed, span: 0.5 }
    }

    #[test]
    fn while_stopping_each_derivative_is_that_of_the_one_before() {
        let h = 1e-5;
        for t in [0.1, 0.25, 0.4] {
            let [before, at, after] = [t - h, t, t + h].map(|t| stopping(t).sample(&Sine));
            let slope = (after.positions[0] - before.positions[0]) / (2.0 * h);
            assert!((slope - at.velocities[0]).abs() < 1e-9);
            let slope = (after.velocities[0] - before.velocities[0]) / (2.0 * h);
            assert!((slope - at.accelerations[0]).abs() < 1e-9);
        }
    }

    #[test]
    fn a_stop_ends_at_rest_half_its_time_further_on() {
        let reference = stopping(0.7);
        assert!((reference.time() - 1.25).abs() < 1e-15);
        assert_eq!(reference.sample(&Sine).velocities, [0.0]);
        assert_eq!(reference.sample(&Sine).accelerations, [0.0]);
        assert!((reference.standing().unwrap() - 0.2).abs() < 1e-15);
        assert_eq!(stopping(0.4).standing(), None);
    }

    #[test]
    fn a_stop_within_no_time_stays_where_it_is() {
        let mut reference = Reference::Running { time: 2.0 };
        reference.stop(0.0);
        assert_eq!(reference.time(), 2.0);
        assert_eq!(reference.sample(&Sine).velocities, [0.0]);
        assert_eq!(reference.standing(), Some(0.0));
    }
}

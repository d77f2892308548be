//! Limits outside the optimizer: what is written, and where the robot is.

use super::settings::LoopSettings;
use std::fmt;

/// A limit that the robot has reached, or would before its brakes could stop it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LimitFault {
    /// The position is outside its limits, or would be after braking.
    Position {
        /// Index of the coordinate.
        joint: usize,
        /// Position [rad or m].
        position: f64,
        /// Where the brakes would stop it [rad or m].
        stopping: f64,
        /// Limits [rad or m].
        limits: [f64; 2],
    },
    /// The speed is above its limit.
    Speed {
        /// Index of the coordinate.
        joint: usize,
        /// Speed [rad/s or m/s].
        speed: f64,
        /// Limit [rad/s or m/s].
        limit: f64,
    },
    /// The robot is too far from where it should be.
    FollowingError {
        /// Index of the coordinate.
        joint: usize,
        /// Measured minus desired position [rad or m].
        error: f64,
        /// Limit of its magnitude [rad or m].
        limit: f64,
    },
}

impl fmt::Display for LimitFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position {
                joint,
                position,
                stopping,
                limits: [low, high],
            } => write!(
                f,
                "joint {joint} at {position:.4} would stop at {stopping:.4}, outside {low:.4} to {high:.4}"
            ),
            Self::Speed {
                joint,
                speed,
                limit,
            } => write!(
                f,
                "joint {joint} moves at {speed:.4}, faster than {limit:.4}"
            ),
            Self::FollowingError {
                joint,
                error,
                limit,
            } => write!(
                f,
                "joint {joint} is {error:.4} away from its desired position, more than {limit:.4}: if this is right after the \
                 start, check signs and order of inputs and encoders"
            ),
        }
    }
}

/// Cuts inputs off at their limits; returns how many were. The inputs must be finite.
pub(super) fn limit_inputs<const M: usize>(inputs: &mut [f64; M], limit: &[f64; M]) -> u64 {
    let mut limited = 0;
    for (u, limit) in inputs.iter_mut().zip(limit) {
        if u.abs() > *limit {
            *u = u.clamp(-limit, *limit);
            limited += 1;
        }
    }
    limited
}

/// Position limits, without looking ahead.
///
/// # Errors
/// [`LimitFault::Position`].
pub(super) fn check_positions<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    positions: &[f64; N],
) -> Result<(), LimitFault> {
    check_stop(settings, positions, positions)
}

/// All limits of the state: `age` is the time since `positions` were measured (s).
///
/// # Errors
/// The first [`LimitFault`].
pub(super) fn check_state<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    positions: &[f64; N],
    velocities: &[f64; N],
    age: f64,
    desired: &[f64; N],
) -> Result<(), LimitFault> {
    let stopping = core::array::from_fn(|i| {
        let v = velocities[i];
        positions[i] + v * age + 0.5 * v * v.abs() / settings.braking_deceleration[i]
    });
    check_stop(settings, positions, &stopping)?;
    for joint in 0..N {
        let (speed, limit) = (velocities[joint], settings.speed_limit[joint]);
        if speed.abs() > limit {
            return Err(LimitFault::Speed {
                joint,
                speed,
                limit,
            });
        }
    }
    // An old position is no measure of the error.
    for joint in (0..N).filter(|_| age == 0.0) {
        let (error, limit) = (
            positions[joint] - desired[joint],
            settings.following_error[joint],
        );
        if error.abs() > limit {
            return Err(LimitFault::FollowingError {
                joint,
                error,
                limit,
            });
        }
    }
    Ok(())
}

fn check_stop<const N: usize, const M: usize>(
    settings: &LoopSettings<N, M>,
    positions: &[f64; N],
    stopping: &[f64; N],
) -> Result<(), LimitFault> {
    for joint in 0..N {
        let limits = settings.position_limits[joint];
        let within = |x: f64| (limits[0]..=limits[1]).contains(&x);
        if !(within(positions[joint]) && within(stopping[joint])) {
            return Err(LimitFault::Position {
                joint,
                position: positions[joint],
                stopping: stopping[joint],
                limits,
            });
        }
    }
    Ok(())
}

/// Velocities by low-pass filtered differences: `v̂ += Δt/(Δt + T_v) ((y − y_before)/Δt − v̂)`.
#[derive(Debug, Clone)]
pub(super) struct VelocityFilter<const N: usize> {
    time_constant: f64,
    positions: [f64; N],
    velocities: [f64; N],
}

impl<const N: usize> VelocityFilter<N> {
    /// At rest.
    pub fn new(time_constant: f64, positions: [f64; N]) -> Self {
        Self {
            time_constant,
            positions,
            velocities: [0.0; N],
        }
    }

    /// Takes positions `span` > 0 seconds after the last ones.
    pub fn update(&mut self, positions: &[f64; N], span: f64) {
        let weight = span / (span + self.time_constant);
        for i in 0..N {
            let slope = (positions[i] - self.positions[i]) / span;
            self.velocities[i] += weight * (slope - self.velocities[i]);
        }
        self.positions = *positions;
    }

    pub fn positions(&self) -> &[f64; N] {
        &self.positions
    }

    pub fn velocities(&self) -> &[f64; N] {
        &self.velocities
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Limits;

    fn settings() -> LoopSettings<1, 1> {
        LoopSettings::for_limits(
            100.0,
            &Limits {
                position: [[-1.0, 1.0]],
                velocity: [2.0],
                effort: [10.0],
                peak_effort: [20.0],
                input: [1.0],
                peak_input: [2.0],
            },
        )
    }

    #[test]
    fn inputs_are_cut_off() {
        let mut inputs = [3.0, -4.0, 0.5];
        assert_eq!(limit_inputs(&mut inputs, &[2.0, 3.0, 1.0]), 2);
        assert_eq!(inputs, [2.0, -3.0, 0.5]);
    }

    #[test]
    fn the_braking_distance_counts() {
        // 2 rad/s and 10 rad/s²: 0.2 rad.
        let at = |y: f64, v: f64| check_state(&settings(), &[y], &[v], 0.0, &[y]);
        assert_eq!(at(0.79, 2.0), Ok(()));
        assert!(matches!(at(0.81, 2.0), Err(LimitFault::Position { .. })));
        assert_eq!(at(0.81, -2.0), Ok(()), "it moves away");
        assert!(matches!(at(-0.81, -2.0), Err(LimitFault::Position { .. })));
        assert!(matches!(at(1.01, 0.0), Err(LimitFault::Position { .. })));
        assert!(matches!(at(0.0, 2.1), Err(LimitFault::Speed { .. })));
    }

    #[test]
    fn an_old_position_is_extrapolated() {
        let at = |age: f64| check_state(&settings(), &[0.7], &[2.0], age, &[0.7]);
        assert_eq!(at(0.04), Ok(()));
        assert!(matches!(at(0.06), Err(LimitFault::Position { .. })));
    }

    #[test]
    fn the_following_error_has_a_limit() {
        let fault = check_state(&settings(), &[0.2], &[0.0], 0.0, &[0.05]).unwrap_err();
        assert!(fault.to_string().contains("check signs"), "{fault}");
    }

    #[test]
    fn velocities_settle_at_the_slope() {
        let mut filter = VelocityFilter::new(0.01, [1.0]);
        for k in 1..=50 {
            filter.update(&[1.0 + 0.005 * f64::from(k)], 0.01);
        }
        assert!((filter.velocities()[0] - 0.5).abs() < 1e-12);
    }
}

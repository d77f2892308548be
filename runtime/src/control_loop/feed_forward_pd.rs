//! Feed-forward with joint PD: the simplest controller, and what the loop falls back on.

use super::controller::{Command, Controller, ControllerFault, Cycle, Estimate};
use super::monitor::VelocityFilter;
use super::settings::{SettingError, require};
use crate::dynamics::Dynamics;
use crate::feed_forward::{FeedForward, FeedForwardError};
use crate::trajectory::{Sample, Trajectory};
use thiserror::Error;

/// Gains of the joint PD, by coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGains<const N: usize> {
    /// K_p [N m/rad or N/m].
    pub position: [f64; N],
    /// K_d [N m s/rad or N s/m].
    pub velocity: [f64; N],
}

impl<const N: usize> JointGains<N> {
    /// Gains that make each joint, with the others at rest, an oscillator of natural frequency `omega` [rad/s] and damping
    /// ratio `damping`: `K_p = M_ii ω²`, `K_d = 2 ζ M_ii ω` with the mass matrix at `positions` (Siciliano, Sciavicco,
    /// Villani, Oriolo, *Robotics*, 2009, section 8.3). Friction of the joint damps in addition.
    #[must_use]
    pub fn from_bandwidth<const M: usize>(
        model: &impl Dynamics<N, M>,
        positions: &[f64; N],
        omega: f64,
        damping: f64,
    ) -> Self {
        let mass = model.mass_matrix(positions);
        Self {
            position: core::array::from_fn(|i| mass[i][i] * omega * omega),
            velocity: core::array::from_fn(|i| 2.0 * damping * mass[i][i] * omega),
        }
    }
}

/// Why there is no joint PD.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum JointPdError {
    /// Gains that are negative or not finite.
    #[error(transparent)]
    Gains(#[from] SettingError),
    /// The model has no feed-forward.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
}

/// The control law, without memory:
///
/// ```text
///     u = u_ff(y_d, ẏ_d, ÿ_d) + B⁺ (K_p (y_d − y) + K_d (ẏ_d − ẏ))
/// ```
///
/// with the [`FeedForward`] u_ff and its B⁺.
#[derive(Debug, Clone)]
pub struct JointPd<D, const N: usize, const M: usize> {
    feed_forward: FeedForward<D, N, M>,
    gains: JointGains<N>,
}

impl<D: Dynamics<N, M>, const N: usize, const M: usize> JointPd<D, N, M> {
    /// The law for a model.
    ///
    /// # Errors
    /// [`JointPdError`].
    pub fn new(model: D, gains: JointGains<N>) -> Result<Self, JointPdError> {
        for (name, values) in [
            ("gains.position", &gains.position),
            ("gains.velocity", &gains.velocity),
        ] {
            require(name, values, "finite and not negative", |x| {
                x.is_finite() && x >= 0.0
            })?;
        }
        Ok(Self {
            feed_forward: FeedForward::new(model)?,
            gains,
        })
    }

    /// Inputs for a desired state, given the measured one.
    ///
    /// # Errors
    /// [`ControllerFault::NotFinite`].
    pub fn inputs(
        &self,
        desired: &Sample<N>,
        positions: &[f64; N],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let correction = self.feed_forward.inputs_for(&core::array::from_fn(|i| {
            self.gains.position[i] * (desired.positions[i] - positions[i])
                + self.gains.velocity[i] * (desired.velocities[i] - velocities[i])
        }));
        let mut inputs = self.feed_forward.at(desired).inputs;
        for (u, du) in inputs.iter_mut().zip(correction) {
            *u += du;
        }
        if inputs.iter().all(|u| u.is_finite()) {
            Ok(inputs)
        } else {
            Err(ControllerFault::NotFinite)
        }
    }
}

/// [`JointPd`] along a trajectory, with velocities from differences of positions.
#[derive(Debug, Clone)]
pub struct FeedForwardPd<D, R, const N: usize, const M: usize> {
    law: JointPd<D, N, M>,
    trajectory: R,
    period: f64,
    time_constant: f64,
    filter: VelocityFilter<N>,
    /// Periods since the last measurement.
    age: u32,
}

impl<D: Dynamics<N, M>, R: Trajectory<N>, const N: usize, const M: usize>
    FeedForwardPd<D, R, N, M>
{
    /// The controller for periods of `period` seconds; velocities are smoothed with `time_constant` (s).
    #[must_use]
    pub fn new(law: JointPd<D, N, M>, trajectory: R, period: f64, time_constant: f64) -> Self {
        let start = trajectory.sample(0.0).positions;
        Self {
            law,
            trajectory,
            period,
            time_constant,
            filter: VelocityFilter::new(time_constant, start),
            age: 0,
        }
    }
}

impl<D: Dynamics<N, M>, R: Trajectory<N>, const N: usize, const M: usize> Controller<N, M>
    for FeedForwardPd<D, R, N, M>
{
    fn reset(&mut self, positions: &[f64; N], _: &[f64; M]) {
        self.filter = VelocityFilter::new(self.time_constant, *positions);
        self.age = 0;
    }

    fn step(&mut self, cycle: &Cycle<N, M>) -> Result<Command<M>, ControllerFault> {
        self.age = self.age.saturating_add(cycle.periods);
        let positions = cycle.positions.ok_or(ControllerFault::NoMeasurement)?;
        let span = f64::from(self.age.max(1)) * self.period;
        self.age = 0;
        self.filter.update(&positions, span);
        let desired = self.trajectory.sample(cycle.time);
        let inputs = self
            .law
            .inputs(&desired, &positions, self.filter.velocities())?;
        Ok(Command {
            inputs,
            iterations: 0,
        })
    }

    fn estimate(&self) -> Option<Estimate<N>> {
        Some(Estimate {
            positions: *self.filter.positions(),
            velocities: *self.filter.velocities(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::RestToRest;

    crate::dynamics!(struct PowerCube = gelenk_generated::powercube);

    #[test]
    fn the_law_is_feed_forward_plus_gains_through_the_gears() {
        let gains = JointGains {
            position: [100.0, 50.0],
            velocity: [10.0, 5.0],
        };
        let law = JointPd::new(PowerCube, gains).unwrap();
        let motion = RestToRest::new([0.0, 0.1], [1.0, 0.5], 2.0).unwrap();
        let desired = motion.sample(0.7);
        let (y, v) = (&desired.positions, &desired.velocities);
        let exact = law.inputs(&desired, y, v).unwrap();
        let off = law
            .inputs(&desired, &[y[0] - 0.161, y[1]], &[v[0], v[1] + 0.322])
            .unwrap();
        // 100 · 0.161 / 161 and −5 · 0.322 / 161: the gear ratio is 161.
        assert!((off[0] - exact[0] - 0.1).abs() < 1e-12);
        assert!((off[1] - exact[1] + 0.01).abs() < 1e-12);
    }

    #[test]
    fn gains_must_be_numbers() {
        let gains = JointGains {
            position: [1.0, f64::NAN],
            velocity: [1.0; 2],
        };
        let error = JointPd::new(PowerCube, gains).unwrap_err();
        assert_eq!(
            error.to_string(),
            "setting gains.position[1] of the loop is NaN; it must be finite and not negative"
        );
    }
}

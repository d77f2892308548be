//! Joint PD law with feed-forward, the usual fallback of the control loop.

use super::controller::ControllerFault;
use super::law::{JointLaw, finite, of_the_model};
use super::settings::{SettingError, require_each};
use crate::dynamics::Dynamics;
use crate::feed_forward::{FeedForward, FeedForwardError};
use crate::trajectory::Sample;
use thiserror::Error;

/// Gains of the joint PD law, one for each coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointGains<const N: usize> {
    /// Position gains K_p [N m/rad or N/m].
    pub position: [f64; N],
    /// Velocity gains K_d [N m s/rad or N s/m].
    pub velocity: [f64; N],
}

impl<const N: usize> JointGains<N> {
    /// Gains `K_p = M_ii ω²` and `K_d = 2 ζ M_ii ω` with the diagonal entries M_ii of the mass matrix at
    /// `positions` and time 0 (Siciliano, Sciavicco, Villani, Oriolo, *Robotics*, 2009, section 8.3). If the
    /// other joints are at rest, the error of each joint is an oscillator with the natural frequency `omega`
    /// (ω) [rad/s] and the damping ratio `damping` (ζ). Joint friction adds damping.
    #[must_use]
    pub fn from_bandwidth<const M: usize, const NY: usize>(
        model: &impl Dynamics<N, M, NY>,
        positions: &[f64; NY],
        omega: f64,
        damping: f64,
    ) -> Self {
        let mass = model.at_time(0.0, |model| model.mass_matrix(positions));
        Self {
            position: core::array::from_fn(|i| mass[i][i] * omega * omega),
            velocity: core::array::from_fn(|i| 2.0 * damping * mass[i][i] * omega),
        }
    }
}

/// Errors of joint PD.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum JointPdError {
    /// A gain is negative or not finite.
    #[error(transparent)]
    Gains(#[from] SettingError),
    /// The feed-forward of the model cannot be computed.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
}

/// Joint PD law with feed-forward, a feedback law without internal state:
///
/// ```text
///     u = u_ff(y_d, ẏ_d, ÿ_d) + B⁺ (K_p (y_d − y) + K_d (ẏ_d − ẏ))
/// ```
///
/// Here u_ff is the [`FeedForward`] for the desired motion y_d, ẏ_d, ÿ_d, and B⁺ is the pseudo-inverse of the
/// input matrix. The model is evaluated along the desired motion, so measurement noise reaches the inputs only
/// through the gains. [`ComputedTorque`](super::ComputedTorque) evaluates the model at the measured state
/// instead. For robots with quaternions the difference is `y_d ⊖ y`, and body velocities v replace ẏ.
#[derive(Debug, Clone)]
pub struct JointPd<D, const N: usize, const M: usize, const NY: usize = N> {
    feed_forward: FeedForward<D, N, M, NY>,
    gains: JointGains<N>,
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> JointPd<D, N, M, NY> {
    /// The law for a model.
    ///
    /// # Errors
    /// [`JointPdError`] if a gain is negative or not finite, or if the feed-forward of the model cannot be
    /// computed.
    pub fn new(model: D, gains: JointGains<N>) -> Result<Self, JointPdError> {
        let names = model.joint_names();
        require_gains("gains.position", &names, &gains.position)?;
        require_gains("gains.velocity", &names, &gains.velocity)?;
        Ok(Self { feed_forward: FeedForward::new(model)?, gains })
    }

    /// Replaces the model. The gains are kept. Does not allocate if the input matrix is unchanged.
    ///
    /// # Errors
    /// [`FeedForwardError::InputMatrix`] if the input matrix cannot be used. The old model is then kept.
    pub fn set_model(&mut self, model: D) -> Result<(), FeedForwardError> {
        self.feed_forward.set_model(model)
    }

    /// The feedback forces `K_p (y_d ⊖ y) + K_d (ẏ_d − ẏ)` with the gains K_p and K_d, the desired motion
    /// y_d, ẏ_d and the measured state y, ẏ.
    fn restoring_forces(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> [f64; N] {
        let error = self.feed_forward.model().difference(positions, &desired.positions);
        core::array::from_fn(|i| {
            self.gains.position[i] * error[i]
                + self.gains.velocity[i] * (desired.velocities[i] - velocities[i])
        })
    }
}

/// Sum of feed-forward and feedback.
///
/// # Errors
/// [`ControllerFault::NotFinite`] if the sum is not finite.
pub(super) fn sum<const M: usize>(
    mut inputs: [f64; M],
    correction: [f64; M],
) -> Result<[f64; M], ControllerFault> {
    for (u, du) in inputs.iter_mut().zip(correction) {
        *u += du;
    }
    finite(inputs)
}

/// Checks that gains are in range.
///
/// # Errors
/// [`SettingError`] for the first gain out of range.
pub(super) fn require_gains<const N: usize>(
    setting: &'static str,
    joints: &[&'static str; N],
    gains: &[f64; N],
) -> Result<(), SettingError> {
    let range = "finite and not negative";
    require_each(setting, joints, gains, range, |x| x.is_finite() && x >= 0.0)
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> JointLaw<N, M, NY>
    for JointPd<D, N, M, NY>
{
    fn inputs(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let forces = self.restoring_forces(desired, positions, velocities);
        let correction = self.feed_forward.inputs_for(positions, &forces);
        sum(self.feed_forward.at(desired).inputs, correction)
    }

    fn inputs_at_time(
        &self,
        time: f64,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let forces = self.restoring_forces(desired, positions, velocities);
        let correction = self.feed_forward.inputs_for_at_time(time, positions, &forces);
        sum(self.feed_forward.at_time(time, desired).inputs, correction)
    }

    of_the_model!();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{RestToRest, Trajectory};

    crate::dynamics!(struct PowerCube = gelenk_generated::powercube);

    #[test]
    fn the_law_is_feed_forward_plus_gains_through_the_gears() {
        let gains = JointGains { position: [100.0, 50.0], velocity: [10.0, 5.0] };
        let law = JointPd::new(PowerCube, gains).unwrap();
        let motion = RestToRest::new([0.0, 0.1], [1.0, 0.5], 2.0).unwrap();
        let desired = motion.sample(0.7);
        let (y, v) = (&desired.positions, &desired.velocities);
        let exact = law.inputs(&desired, y, v).unwrap();
        let off = law.inputs(&desired, &[y[0] - 0.161, y[1]], &[v[0], v[1] + 0.322]).unwrap();
        // 100 · 0.161 / 161 and −5 · 0.322 / 161: the gear ratio is 161.
        assert!((off[0] - exact[0] - 0.1).abs() < 1e-12);
        assert!((off[1] - exact[1] + 0.01).abs() < 1e-12);
    }

    #[test]
    fn gains_must_be_numbers() {
        let gains = JointGains { position: [1.0, f64::NAN], velocity: [1.0; 2] };
        let error = JointPd::new(PowerCube, gains).unwrap_err();
        assert_eq!(
            error.to_string(),
            "setting gains.position[gamma] of the loop is NaN, but must be finite and not negative"
        );
    }
}

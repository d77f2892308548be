//! Computed torque: feedback through the model at the measured state.

use super::controller::ControllerFault;
use super::joint_pd::require_gains;
use super::law::{JointLaw, finite, of_the_model};
use super::settings::SettingError;
use crate::dynamics::{Dynamics, Named};
use crate::feed_forward::{FeedForward, FeedForwardError, closest_to_neutral};
use crate::trajectory::Sample;
use thiserror::Error;

/// Gains of [`ComputedTorque`], one for each coordinate. The gains map errors to accelerations, so suitable
/// gains do not depend on the masses of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationGains<const N: usize> {
    /// Position gains K_p [1/s²].
    pub position: [f64; N],
    /// Velocity gains K_d [1/s].
    pub velocity: [f64; N],
}

impl<const N: usize> AccelerationGains<N> {
    /// Gains `K_p = ω²` and `K_d = 2 ζ ω` for the natural frequency `omega` (ω) [rad/s] and the damping ratio
    /// `damping` (ζ) of every error.
    #[must_use]
    pub fn from_bandwidth(omega: f64, damping: f64) -> Self {
        Self { position: [omega * omega; N], velocity: [2.0 * damping * omega; N] }
    }
}

/// Errors of computed torque.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ComputedTorqueError {
    /// A gain is negative or not finite.
    #[error(transparent)]
    Gains(#[from] SettingError),
    /// The feed-forward of the model cannot be computed.
    #[error(transparent)]
    FeedForward(#[from] FeedForwardError),
    /// The inputs cannot produce an arbitrary force at this joint. Computed torque needs a drive for every
    /// coordinate.
    #[error(
        "the inputs cannot produce an arbitrary force at joint {}. Computed torque needs a drive for every coordinate. Use \
         `JointPd` instead",
        Named(.name)
    )]
    Underactuated {
        /// Index of the coordinate.
        joint: usize,
        /// Name of the joint.
        name: &'static str,
    },
}

/// Computed-torque law, a feedback law without internal state:
///
/// ```text
///     u = B⁻¹ (M(y) (ÿ_d + K_d (ẏ_d − ẏ) + K_p (y_d − y)) + k(y, ẏ) − q(y, ẏ))
/// ```
///
/// This is the inverse dynamics at the measured state y, ẏ with the desired motion y_d, ẏ_d, ÿ_d and the
/// equations of motion `M ÿ + k = q + B u`. With an exact model the error e = y_d − y of each coordinate
/// satisfies `ë + K_d ė + K_p e = 0` everywhere (Siciliano, Sciavicco, Villani, Oriolo, *Robotics*, 2009,
/// section 8.5.2; Craig, *Introduction to Robotics*, 2005, chapter 10).
///
/// Compared with [`JointPd`](super::JointPd), large errors decay like small errors, and gains need not be tuned
/// to the masses. However, measurement noise of positions and velocities passes through M, k and q. If the
/// friction law is steep at rest, noise of the velocity switches the sign of the friction torque. Use a model
/// with smooth friction, and measured velocities if available. `JointPd` amplifies noise less and is therefore
/// the better fallback of a loop.
///
/// For robots with quaternions the error is e = y_d ⊖ y. Measured and desired velocities v and v_d are
/// expressed in the frames of the bodies. The desired velocities are transformed to the frames of the measured
/// bodies, `w = Ad v_d` with the adjoint Ad of exp(e). The acceleration
///
/// ```text
///     v̇ = Ad v̇_d − ad_v w + K_d (w − v) + K_p e
/// ```
///
/// replaces the acceleration in the equation above. Then `d/dt (w − v) = −K_d (w − v) − K_p e`. The error e
/// decays along one axis, like the errors of other joints, under two conditions. The gains of the entries of
/// a joint must be equal, and w − v must initially be parallel to e. At the start of a motion that begins at
/// rest, w − v is zero. From other states an attitude error also decays, unless it is 180° (Bullo and Murray,
/// "Tracking for fully actuated mechanical systems: a geometric framework", Automatica 35, 1999).
///
/// ```
/// use gelenk_runtime::control_loop::{AccelerationGains, ComputedTorque, JointLaw};
/// use gelenk_runtime::trajectory::Sample;
///
/// gelenk_runtime::dynamics!(pub struct Ur5 = gelenk_generated::ur5);
///
/// let law = ComputedTorque::new(Ur5, AccelerationGains::from_bandwidth(10.0, 1.0))?;
/// let rest = Sample::at_rest([0.0; 6]);
/// let inputs = law.inputs(&rest, &[0.01; 6], &[0.0; 6])?;
/// assert!(inputs.iter().all(|u| u.is_finite()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ComputedTorque<D, const N: usize, const M: usize, const NY: usize = N> {
    feed_forward: FeedForward<D, N, M, NY>,
    gains: AccelerationGains<N>,
}

/// Largest part of a unit force that the inputs may fail to produce because of rounding of the pseudo-inverse
/// B⁺ of the input matrix.
const MISSED: f64 = 1e-9;

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> ComputedTorque<D, N, M, NY> {
    /// The law for a model.
    ///
    /// # Errors
    /// [`ComputedTorqueError`] if a gain is negative or not finite, if the feed-forward of the model cannot be
    /// computed, or if a coordinate has no drive.
    pub fn new(model: D, gains: AccelerationGains<N>) -> Result<Self, ComputedTorqueError> {
        let names = model.joint_names();
        require_gains("gains.position", &names, &gains.position)?;
        require_gains("gains.velocity", &names, &gains.velocity)?;
        let feed_forward = FeedForward::new(model)?;
        let positions = closest_to_neutral(feed_forward.model());
        for joint in 0..N {
            let mut force = [0.0; N];
            force[joint] = 1.0;
            let missed = feed_forward.missed_at_time(0.0, &positions, &force).map(f64::abs);
            if missed.iter().any(|r| *r > MISSED) {
                let name = names[joint];
                return Err(ComputedTorqueError::Underactuated { joint, name });
            }
        }
        Ok(Self { feed_forward, gains })
    }

    /// The acceleration `ÿ_d + K_d (ẏ_d − ẏ) + K_p (y_d − y)` of the desired motion y_d with the feedback of
    /// position and velocity errors by the gains K_p and K_d. [`ComputedTorque`] documents the acceleration
    /// for quaternions.
    fn accelerations(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> [f64; N] {
        let model = self.feed_forward.model();
        let error = model.difference(positions, &desired.positions);
        let (seen_velocities, seen_accelerations) = if NY == N {
            (desired.velocities, desired.accelerations)
        } else {
            seen_from_the_body(model, desired, &error, velocities)
        };
        core::array::from_fn(|i| {
            seen_accelerations[i]
                + self.gains.velocity[i] * (seen_velocities[i] - velocities[i])
                + self.gains.position[i] * error[i]
        })
    }
}

/// Desired velocities v_d in the frames of the measured bodies, `w = Ad v_d` with the adjoint Ad of the
/// attitude error, and their rate `Ad v̇_d − ad_v w`.
fn seen_from_the_body<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize>(
    model: &D,
    desired: &Sample<N, NY>,
    error: &[f64; N],
    velocities: &[f64; N],
) -> ([f64; N], [f64; N]) {
    // The derivative of y ⊕ d by y is the adjoint of exp(−d).
    let (adjoint, _) = model.integrate_derivatives(&desired.positions, &error.map(|e| -e));
    let seen = |x: &[f64; N]| adjoint.map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>());
    let (seen_velocities, carried) = (seen(&desired.velocities), seen(&desired.accelerations));
    let turned = model.bracket(velocities, &seen_velocities);
    (seen_velocities, core::array::from_fn(|i| carried[i] - turned[i]))
}

impl<D: Dynamics<N, M, NY>, const N: usize, const M: usize, const NY: usize> JointLaw<N, M, NY>
    for ComputedTorque<D, N, M, NY>
{
    fn inputs(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let accelerations = self.accelerations(desired, positions, velocities);
        let forces = self.feed_forward.model().inverse_dynamics(positions, velocities, &accelerations);
        finite(self.feed_forward.inputs_for(positions, &forces))
    }

    fn inputs_at_time(
        &self,
        time: f64,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let accelerations = self.accelerations(desired, positions, velocities);
        let inverse = |model: &D| model.inverse_dynamics(positions, velocities, &accelerations);
        let forces = self.feed_forward.model().at_time(time, inverse);
        finite(self.feed_forward.inputs_for_at_time(time, positions, &forces))
    }

    of_the_model!();
}

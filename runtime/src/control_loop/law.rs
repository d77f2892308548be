//! Feedback laws without internal state.

use super::controller::ControllerFault;
use crate::dynamics::{AttitudeError, DependentJoint, QuaternionJoint, numbered};
use crate::trajectory::Sample;

/// A feedback law without internal state, which maps desired and measured state to inputs. The control loop
/// uses a law as fallback and for the controlled stop. [`LawController`](super::LawController) follows a
/// trajectory with a law.
///
/// [`JointPd`](super::JointPd) and [`JointLqr`](super::JointLqr) evaluate the model along the desired motion,
/// [`ComputedTorque`](super::ComputedTorque) at the measured state.
pub trait JointLaw<const N: usize, const M: usize, const NY: usize = N> {
    /// Inputs [N m, N or A] for a desired state, from the measured positions [rad or m] and velocities [rad/s
    /// or m/s].
    ///
    /// # Errors
    /// [`ControllerFault::NotFinite`] if the inputs are not finite.
    fn inputs(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault>;

    /// Inputs at `time` (s) of the loop, in which the trajectory starts at 0. The control loop calls this
    /// method. Only laws for robots with driven joints depend on the time
    /// ([`Dynamics::at_time`](crate::dynamics::Dynamics::at_time)). The default ignores the time. While the
    /// loop slows down along the path, `desired` belongs to an earlier time.
    ///
    /// # Errors
    /// The errors of [`Self::inputs`].
    fn inputs_at_time(
        &self,
        time: f64,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault> {
        let _ = time;
        self.inputs(desired, positions, velocities)
    }

    /// Position and velocity of a joint that follows others, at `time` (s), for the given positions and
    /// velocities of the coordinates. The loop keeps the limits of this joint. Laws for robots with driven
    /// joints use the driven motion. The default gives NaN for joints that follow driven joints, so the loop
    /// brakes if they have limits.
    fn dependent_motion_at_time(
        &self,
        time: f64,
        joint: &DependentJoint<N>,
        (coordinates, velocities): (&[f64; N], &[f64; N]),
    ) -> [f64; 2] {
        let _ = time;
        joint.motion(coordinates, velocities, &[])
    }

    /// Names of the joints of the model, for messages of the loop.
    fn joint_names(&self) -> [&'static str; N] {
        numbered()
    }

    /// Names of the inputs, for messages of the loop.
    fn input_names(&self) -> [&'static str; M] {
        numbered()
    }

    /// Joints of the model with quaternions; empty for arms. For other robots the defaults of this method,
    /// [`Self::difference`] and [`Self::check_attitudes`] do not compile.
    fn quaternion_joints(&self) -> &'static [QuaternionJoint] {
        const { assert!(NY == N, "a law for a robot with quaternions must list its joints with quaternions") }
        &[]
    }

    /// The difference `to ⊖ from` of the model, which the loop uses for distances.
    fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
        const { assert!(NY == N, "a law for a robot with quaternions must compute their differences") }
        core::array::from_fn(|i| to[i] - from[i])
    }

    /// Checks that all quaternions in `positions` are attitudes, as the model does.
    ///
    /// # Errors
    /// [`AttitudeError`] for the first quaternion that is not an attitude.
    fn check_attitudes(&self, positions: &[f64; NY]) -> Result<(), AttitudeError> {
        const { assert!(NY == N, "a law for a robot with quaternions must check them") }
        let _ = positions;
        Ok(())
    }
}

/// Implements the methods of a law that call the model of its `feed_forward`.
macro_rules! of_the_model {
    () => {
        fn dependent_motion_at_time(
            &self,
            time: f64,
            joint: &$crate::dynamics::DependentJoint<N>,
            (coordinates, velocities): (&[f64; N], &[f64; N]),
        ) -> [f64; 2] {
            let of = |model: &D| joint.motion(coordinates, velocities, model.driven_motion());
            self.feed_forward.model().at_time(time, of)
        }

        fn joint_names(&self) -> [&'static str; N] {
            self.feed_forward.model().joint_names()
        }

        fn input_names(&self) -> [&'static str; M] {
            self.feed_forward.model().input_names()
        }

        fn quaternion_joints(&self) -> &'static [$crate::dynamics::QuaternionJoint] {
            self.feed_forward.model().quaternion_joints()
        }

        fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
            self.feed_forward.model().difference(from, to)
        }

        fn check_attitudes(&self, positions: &[f64; NY]) -> Result<(), $crate::dynamics::AttitudeError> {
            self.feed_forward.model().check_attitudes(positions)
        }
    };
}
pub(super) use of_the_model;

/// Returns the inputs.
///
/// # Errors
/// [`ControllerFault::NotFinite`] if the inputs are not finite.
pub(super) fn finite<const M: usize>(inputs: [f64; M]) -> Result<[f64; M], ControllerFault> {
    if inputs.iter().all(|u| u.is_finite()) { Ok(inputs) } else { Err(ControllerFault::NotFinite) }
}

//! Feedback laws without internal state.

use super::controller::ControllerFault;
use crate::dynamics::{AttitudeError, DependentJoint, QuaternionJoint, numbered};
use crate::trajectory::Sample;

/// A feedback law without internal state. It maps desired and measured state to inputs. The control loop uses a
/// law as fallback and for the controlled stop. [`LawController`](super::LawController) makes a controller of a
/// law and a trajectory.
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

    /// Inputs [N m, N or A] at `time` (s) after the start of the trajectory. The control loop calls this method.
    /// Only laws for robots with driven joints depend on the time
    /// ([`Dynamics::at_time`](crate::dynamics::Dynamics::at_time)). The default ignores the time. During a
    /// controlled stop, `desired` is the desired state of an earlier time, because the trajectory slows down.
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

    /// Position [rad or m] and velocity [rad/s or m/s] of a joint that follows other joints, at `time` (s) and for
    /// the given positions and velocities of the coordinates. The loop uses the result to check the limits of
    /// this joint. Laws for robots with driven joints must include the driven motion. The default returns NaN
    /// for a joint that follows driven joints. The loop then brakes if this joint has limits.
    fn dependent_motion_at_time(
        &self,
        time: f64,
        joint: &DependentJoint<N>,
        coordinates: &[f64; N],
        velocities: &[f64; N],
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

    /// Joints with quaternions. The list is empty for robots without quaternions, for example arms. Laws for
    /// robots with quaternions must implement this method, [`Self::difference`] and [`Self::check_attitudes`],
    /// because the defaults do not compile for these robots.
    fn quaternion_joints(&self) -> &'static [QuaternionJoint] {
        const { assert!(NY == N, "a law for a robot with quaternions must list its joints with quaternions") }
        &[]
    }

    /// The difference `to ⊖ from` of two positions, one entry for each velocity [rad or m]. The loop uses the
    /// difference for distances.
    fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
        const { assert!(NY == N, "a law for a robot with quaternions must compute their differences") }
        core::array::from_fn(|i| to[i] - from[i])
    }

    /// Checks that all quaternions in `positions` are attitudes. The check is the one of the model
    /// ([`Dynamics::check_attitudes`](crate::dynamics::Dynamics::check_attitudes)).
    ///
    /// # Errors
    /// [`AttitudeError`] for the first quaternion that is not an attitude.
    fn check_attitudes(&self, positions: &[f64; NY]) -> Result<(), AttitudeError> {
        const { assert!(NY == N, "a law for a robot with quaternions must check them") }
        let _ = positions;
        Ok(())
    }
}

/// Implements methods of a law by calls of the model in its `feed_forward`.
macro_rules! of_the_model {
    () => {
        fn dependent_motion_at_time(
            &self,
            time: f64,
            joint: &$crate::dynamics::DependentJoint<N>,
            coordinates: &[f64; N],
            velocities: &[f64; N],
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

/// Returns the inputs if all of them are finite.
///
/// # Errors
/// [`ControllerFault::NotFinite`] if the inputs are not finite.
pub(super) fn finite<const M: usize>(inputs: [f64; M]) -> Result<[f64; M], ControllerFault> {
    if inputs.iter().all(|u| u.is_finite()) { Ok(inputs) } else { Err(ControllerFault::NotFinite) }
}

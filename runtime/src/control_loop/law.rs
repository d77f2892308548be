//! Feedback laws without memory.

use super::controller::ControllerFault;
use crate::dynamics::{AttitudeError, DependentJoint, QuaternionJoint, numbered};
use crate::trajectory::Sample;

/// A feedback law without memory: inputs from a desired state and the measured one. The loop falls back on
/// one where its controller fails, and makes the controlled stop with it; [`LawController`](super::LawController) follows a
/// trajectory by one.
///
/// [`JointPd`](super::JointPd) and [`JointLqr`](super::JointLqr) evaluate the model along the desired motion,
/// [`ComputedTorque`](super::ComputedTorque) at the measured state.
pub trait JointLaw<const N: usize, const M: usize, const NY: usize = N> {
    /// Inputs [the model's units] for a desired state, given the measured positions [rad or m] and velocities
    /// [rad/s or m/s].
    ///
    /// # Errors
    /// [`ControllerFault::NotFinite`].
    fn inputs(
        &self,
        desired: &Sample<N, NY>,
        positions: &[f64; NY],
        velocities: &[f64; N],
    ) -> Result<[f64; M], ControllerFault>;

    /// The same at `time` (s) of the loop, which began the trajectory at 0: the loop asks here. Laws over robots with driven
    /// joints need it ([`Dynamics::at_time`](crate::dynamics::Dynamics::at_time)); for others time changes nothing, and so
    /// says this body. While the loop slows down on the path, `desired` is that of an earlier time.
    ///
    /// # Errors
    /// As [`Self::inputs`].
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

    /// Position and velocity at `time` (s) of a joint that follows coordinates, given theirs: the loop keeps its limits.
    /// Laws over robots with driven joints know the motion of those; by this body, a joint that follows one has no number,
    /// and the loop brakes where such a joint has limits.
    fn dependent_motion_at_time(
        &self,
        time: f64,
        joint: &DependentJoint<N>,
        (coordinates, velocities): (&[f64; N], &[f64; N]),
    ) -> [f64; 2] {
        let _ = time;
        joint.motion(coordinates, velocities, &[])
    }

    /// Names of the joints, for the loop's messages: those of the model.
    fn joint_names(&self) -> [&'static str; N] {
        numbered()
    }

    /// Names of the inputs.
    fn input_names(&self) -> [&'static str; M] {
        numbered()
    }

    /// The joints with a quaternion: those of the model, none for arms. For other robots this, [`Self::difference`]
    /// and [`Self::check_attitudes`] do not compile without bodies of their own.
    fn quaternion_joints(&self) -> &'static [QuaternionJoint] {
        const { assert!(NY == N, "a law for a robot with quaternions says which joints have them") }
        &[]
    }

    /// `to ⊖ from`: that of the model, by which the loop measures distances.
    fn difference(&self, from: &[f64; NY], to: &[f64; NY]) -> [f64; N] {
        const { assert!(NY == N, "a law for a robot with quaternions knows their differences") }
        core::array::from_fn(|i| to[i] - from[i])
    }

    /// Whether the quaternions of positions are attitudes, as the model does.
    ///
    /// # Errors
    /// The first one that is none.
    fn check_attitudes(&self, positions: &[f64; NY]) -> Result<(), AttitudeError> {
        const { assert!(NY == N, "a law for a robot with quaternions checks them") }
        let _ = positions;
        Ok(())
    }
}

/// The methods of a law that are those of the model of its `feed_forward`.
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

/// The inputs, if they are numbers.
pub(super) fn finite<const M: usize>(inputs: [f64; M]) -> Result<[f64; M], ControllerFault> {
    if inputs.iter().all(|u| u.is_finite()) { Ok(inputs) } else { Err(ControllerFault::NotFinite) }
}

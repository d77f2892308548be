//! Moments 2 ∫ ṙ dm and 2 ∫ ṙ rᵀ dm of a body with all bodies beyond it, and the levers for their
//! transformation.

use super::column::Disturbed;
use crate::dynamics::recursion::composite::Composite;
use crate::dynamics::recursion::motion::{BodyMotion, MotionInput};
use crate::dynamics::recursion::placement::Placement;
use crate::dynamics::recursion::quaternion::{Passage, own_motion};
use crate::graph::Scalar;
use crate::kinematics::{Body, JointAxis, Mechanism};
use crate::spatial::{Force, MassMoments, Matrix3, Vector3};

/// Moments of mass of a body with all bodies beyond it, and the moments of its velocities: 2 ∫ ṙ dm
/// (`momentum`) and 2 ∫ ṙ rᵀ dm (`spin`).
#[derive(Clone, Copy)]
pub(super) struct Flow<'g> {
    pub(super) composite: Composite<'g>,
    pub(super) momentum: Vector3<Scalar<'g>>,
    pub(super) spin: Matrix3<'g>,
}

/// Lever of a joint along z in the body's frame, and twice the velocities of two levers. These are the lever
/// along z, and the lever from the parent's origin to the joint's axis in the parent's frame.
#[derive(Clone, Copy)]
pub(super) struct Lever<'g> {
    pub(super) along: Scalar<'g>,
    pub(super) along_velocity: Vector3<Scalar<'g>>,
    pub(super) across_velocity: Vector3<Scalar<'g>>,
}

pub(super) fn levers<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    placements: &[Placement<'g>],
    motions: &[BodyMotion<'g>],
    input: MotionInput<'_, 'g>,
) -> Vec<Lever<'g>> {
    let zero = mechanism.graph.constant(0.0);
    let lever = |(index, body): (usize, &Body<Scalar<'g>>)| {
        let rate = match body.axis {
            // All bodies of a chain have the motion of the chain's last body.
            _ if body.chain.is_some() => zero,
            JointAxis::Revolute => zero,
            JointAxis::Prismatic => body.transmission.motion(input.v),
        };
        let twice = twice_across(motions[index].omega);
        let along = placements[index].extension;
        let mut along_velocity = twice.scaled(along);
        along_velocity.0[2] = rate * 2.0;
        let across_velocity = match body.parent {
            Some(parent) => motions[parent].omega.cross(placements[index].translation),
            None => Vector3::zero(zero),
        };
        let slid = match body.chain.filter(|place| place.first == index) {
            Some(place) => {
                let passage = Passage { mechanism, placements, place };
                passage.to_parent(own_motion(mechanism, place, input.v).linear)
            }
            None => Vector3::zero(zero),
        };
        let across_velocity = (across_velocity + slid).map(|x| x * 2.0);
        Lever { along, along_velocity, across_velocity }
    };
    mechanism.bodies.iter().enumerate().map(lever).collect()
}

/// Vector `2 ω × z` with the unit vector z.
pub(super) fn twice_across(omega: Vector3<Scalar<'_>>) -> Vector3<Scalar<'_>> {
    Vector3([omega[1] * 2.0, -(omega[0] * 2.0), omega[2].constant(0.0)])
}

impl<'g> Flow<'g> {
    /// Force, and moment about the origin, that a change of the body's motion requires. The change consists
    /// of δω, β = δω̇ + ω × δω and the change of the origin's acceleration.
    pub(super) fn response(&self, disturbed: &Disturbed<'g>) -> Force<'g> {
        let Disturbed { omega, beta, acceleration } = *disturbed;
        let moments = self.composite.moments;
        let force =
            acceleration.scaled(moments.mass) + beta.cross(moments.first) + omega.cross(self.momentum);
        let moment = moments.first.cross(acceleration)
            + self.composite.inertia_times(beta)
            + self.spin.complement_times(omega);
        Force { moment, force }
    }
}

/// Transforms the moments 2 ∫ ṙ dm and 2 ∫ ṙ rᵀ dm to another point, from which the old point has the
/// position `lever`. `velocity` is twice the rate of the lever.
pub(super) fn shift_flow<'g>(
    moments: MassMoments<Scalar<'g>>,
    momentum: Vector3<Scalar<'g>>,
    spin: &Matrix3<'g>,
    lever: Vector3<Scalar<'g>>,
    velocity: Vector3<Scalar<'g>>,
) -> (Vector3<Scalar<'g>>, Matrix3<'g>) {
    let moved = momentum + velocity.scaled(moments.mass);
    let entry = |i: usize, j: usize| spin[i][j] + (moved[i] * lever[j] + velocity[i] * moments.first[j]);
    (moved, Matrix3::from_fn(entry))
}

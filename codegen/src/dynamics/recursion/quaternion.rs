//! Motion of spherical and floating joints. The velocities of such a joint are velocities of its body in the
//! frame of the body. The joint is a chain of bodies, one per velocity. Only the last body of the chain has a
//! mass.
//!
//! R is the rotation of the joint, and l and ν are its linear and angular velocity. ω_c, ω̇_c and a_c are the
//! parent's motion in the body's axes. `ω̇_c = Rᵀ ω̇_p` is the parent's angular acceleration ω̇_p in the
//! body's axes, and not the time derivative of the components of ω_c. The motion of the body is
//!
//! ```text
//! ω = ω_c + ν          ω̇ = ω̇_c + ν̇ + ω_c × ν          a = a_c + l̇ + (ω + ω_c) × l
//! ```
//!
//! A unit of an angular velocity along the unit vector e, or of a small motion along e, changes the motion by
//!
//! ```text
//! by the velocity:    δω = e           β = (2 ω − ν) × e                                   δa = e × l
//! by the position:    δω = ω_c × e     β = ω̇_c × e + (ω_c × e) × ν + ω × (ω_c × e)         δa = a_c × e + 2 (ω_c × e) × l
//! ```
//!
//! For a linear velocity along e the changes are `δa = (ω + ω_c) × e` by the velocity and `δa = U_c e` by the
//! position. β and U are defined in `derivatives/`.

use super::motion::{BodyMotion, ChainMotion, MotionInput, spread_of};
use super::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{ChainPlace, Mechanism};
use crate::spatial::{Force, Motion, Vector3};

/// Linear and angular velocity of a spherical or floating joint, in the frame of the moved body. If `values`
/// are accelerations, the result contains the rates of these velocities.
pub(super) fn own_motion<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    place: ChainPlace,
    values: &[Scalar<'g>],
) -> Motion<'g> {
    let nothing = Vector3::zero(mechanism.graph.constant(0.0));
    let mut motion = Motion { angular: nothing, linear: nothing };
    for body in &mechanism.bodies[place.first..=place.last] {
        let Some(own) = body.chain else { continue };
        let part = if body.axis.turns() { &mut motion.angular } else { &mut motion.linear };
        part.0[own.axis] = body.transmission.motion(values);
    }
    motion
}

/// Transformation of vectors between the frame of a joint's parent and the frame of the body that a joint
/// with a quaternion moves.
pub(super) struct Passage<'a, 'g> {
    pub mechanism: &'a Mechanism<Scalar<'g>>,
    pub placements: &'a [Placement<'g>],
    pub place: ChainPlace,
}

impl<'g> Passage<'_, 'g> {
    fn to_last(&self, mut v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        for index in self.place.first..=self.place.last {
            v = self.placements[index].to_child(&self.mechanism.bodies[index].twist, v);
        }
        v
    }

    /// Transforms a vector from the moved body's frame to the axes of the joint's parent.
    pub fn to_parent(&self, mut v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        for index in (self.place.first..=self.place.last).rev() {
            v = self.placements[index].to_parent(&self.mechanism.bodies[index].twist, v);
        }
        v
    }

    /// Motion of the last body of the chain that replaces a joint with a quaternion. All bodies of the chain
    /// use this motion, because the other bodies have no mass.
    pub fn motion(&self, parent: &BodyMotion<'g>, input: MotionInput<'_, 'g>) -> BodyMotion<'g> {
        let translation = self.placements[self.place.first].translation;
        let carried_omega = self.to_last(parent.omega);
        let carried_angular = self.to_last(parent.angular_acceleration());
        let origin = parent.acceleration + parent.spread.times(translation);
        let chain = ChainMotion {
            carried_omega,
            carried_angular,
            carried_spread: spread_of(carried_omega, carried_angular),
            carried_acceleration: self.to_last(origin),
            linear: own_motion(self.mechanism, self.place, input.v).linear,
            turning: own_motion(self.mechanism, self.place, input.v).angular,
        };
        let rates = own_motion(self.mechanism, self.place, input.a);
        let omega = carried_omega + chain.turning;
        let angular = carried_angular + rates.angular + carried_omega.cross(chain.turning);
        let swept = (omega + carried_omega).cross(chain.linear);
        let acceleration = chain.carried_acceleration + rates.linear + swept;
        BodyMotion::of_chain(omega, angular, acceleration, chain)
    }
}

/// Changes of the body's motion for a unit of one velocity of its joint, and for a unit of small motion along
/// this velocity.
pub(super) struct ChainDisturbance<'g> {
    /// Changes per unit of small displacement: δω of the body's angular velocity ω, β = δω̇ + ω × δω, and δa
    /// of its origin's acceleration.
    pub by_position: [Vector3<Scalar<'g>>; 3],
    /// Changes per unit of velocity: δω of the body's angular velocity ω, β = δω̇ + ω × δω, and δa of its
    /// origin's acceleration.
    pub by_velocity: [Vector3<Scalar<'g>>; 3],
}

impl<'g> ChainMotion<'g> {
    /// Changes of the body's motion along one velocity of its joint with a quaternion.
    ///
    /// - `omega`: angular velocity of the last body
    /// - `turns`: whether the velocity is angular
    /// - `e`: unit vector of the velocity in the frame of the last body
    pub(super) fn disturbance(
        &self,
        omega: Vector3<Scalar<'g>>,
        turns: bool,
        e: Vector3<Scalar<'g>>,
    ) -> ChainDisturbance<'g> {
        let nothing = Vector3::zero(e[0]);
        if !turns {
            return ChainDisturbance {
                by_position: [nothing, nothing, self.carried_spread.times(e)],
                by_velocity: [nothing, nothing, (omega + self.carried_omega).cross(e)],
            };
        }
        let swept = self.carried_omega.cross(e);
        let turned = self.carried_angular.cross(e) + swept.cross(self.turning) + omega.cross(swept);
        let twice = |v: Vector3<Scalar<'g>>| v.map(|x| x * 2.0);
        let moved = self.carried_acceleration.cross(e) + twice(swept).cross(self.linear);
        ChainDisturbance {
            by_position: [swept, turned, moved],
            // The sum ω + ω_c is equal to 2 ω − ν.
            by_velocity: [e, (omega + self.carried_omega).cross(e), e.cross(self.linear)],
        }
    }
}

/// Motion of the body moved by a joint with a quaternion for a unit of one velocity, in the body's frame.
///
/// - `turns`: whether the velocity is angular
/// - `place`: place of the velocity among the joint's velocities
pub(super) fn unit_motion<'g>(turns: bool, place: ChainPlace, any: Scalar<'g>) -> Motion<'g> {
    let mut e = Vector3::zero(any);
    e.0[place.axis] = any.constant(1.0);
    match turns {
        true => Motion { angular: e, linear: Vector3::zero(any) },
        false => Motion { angular: Vector3::zero(any), linear: e },
    }
}

/// Component of a wrench on the moved body along one velocity of its joint with a quaternion.
pub(super) fn force_along(turns: bool, place: ChainPlace, f: Force<'_>) -> Scalar<'_> {
    if turns { f.moment[place.axis] } else { f.force[place.axis] }
}

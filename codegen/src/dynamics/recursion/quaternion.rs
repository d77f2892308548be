//! Motion of spherical and floating joints, whose velocities are those of the body in its own frame.
//!
//! With R the rotation of the joint, ω_c, ω̇_c and a_c what its parent gives to the body (`ω̇_c = Rᵀ ω̇_p` is the carried
//! acceleration, not the rate of the components of ω_c), l and ν the joint's linear and angular velocity:
//!
//! ```text
//! ω = ω_c + ν          ω̇ = ω̇_c + ν̇ + ω_c × ν          a = a_c + l̇ + (ω + ω_c) × l
//! ```
//!
//! A small motion δ of the joint along its own velocities disturbs this by, for a turning column e,
//!
//! ```text
//! by the velocity:    δω = e           β = (2 ω − ν) × e                                   δa = e × l
//! by the position:    δω = ω_c × e     β = ω̇_c × e + (ω_c × e) × ν + ω × (ω_c × e)         δa = a_c × e + 2 (ω_c × e) × l
//! ```
//!
//! and for a sliding one by `δa = (ω + ω_c) × e` and `δa = U_c e`, with β and U as elsewhere.

use super::motion::{BodyMotion, ChainMotion, MotionInput, spread_of};
use super::placement::Placement;
use crate::graph::Scalar;
use crate::kinematics::{ChainPlace, Mechanism};
use crate::spatial::{Force, Motion, Vector3};

/// The velocities of a chain's joint: l and ν in the frame of its last body.
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

/// A vector of the parent in the frame of the chain's last body, and back.
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

    /// In the axes of the joint's parent.
    pub fn to_parent(&self, mut v: Vector3<Scalar<'g>>) -> Vector3<Scalar<'g>> {
        for index in (self.place.first..=self.place.last).rev() {
            v = self.placements[index].to_parent(&self.mechanism.bodies[index].twist, v);
        }
        v
    }

    /// The motion of the last body, which stands for those of the whole chain: the bodies before it have no mass.
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

/// Changes by a small motion along one velocity of a joint, or by that velocity.
pub(super) struct ChainDisturbance<'g> {
    /// δω, β and δa by the position.
    pub by_position: [Vector3<Scalar<'g>>; 3],
    /// The same by the velocity.
    pub by_velocity: [Vector3<Scalar<'g>>; 3],
}

impl<'g> ChainMotion<'g> {
    /// - `omega`: that of the last body
    /// - `screw`: the unit motion of the velocity
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
            // 2 ω − ν
            by_velocity: [e, (omega + self.carried_omega).cross(e), e.cross(self.linear)],
        }
    }
}

/// The unit motion of a velocity in the frame of the chain's last body.
pub(super) fn unit_motion<'g>(turns: bool, place: ChainPlace, any: Scalar<'g>) -> Motion<'g> {
    let mut e = Vector3::zero(any);
    e.0[place.axis] = any.constant(1.0);
    match turns {
        true => Motion { angular: e, linear: Vector3::zero(any) },
        false => Motion { angular: Vector3::zero(any), linear: e },
    }
}

/// Component of a force on the last body along one velocity.
pub(super) fn force_along(turns: bool, place: ChainPlace, f: Force<'_>) -> Scalar<'_> {
    if turns { f.moment[place.axis] } else { f.force[place.axis] }
}

//! Rotors on the parent bodies of their joints.
//!
//! Per unit of its joint's velocity, such a rotor has the momentum h = i J a with the gear ratio i, the axial
//! inertia J and the axis a. The rotor couples its joint with every joint between the base and this joint,
//! but not with the joint itself. The same holds for the columns of the Jacobians. The equations are those of
//! `recursion/rotor.rs`, with ω and ω̇ of the parent. Sums over the subtree of a joint do not include the
//! joint's own rotor.

use super::bodies::{Composites, Motions};
use super::builder::ArrayBuilder;
use super::rows::{flat, force_of, motion_of, vector};
use super::setup::Setup;
use crate::graph::Scalar;
use crate::program::arrays::ArrayId;
use crate::spatial::{Force, Matrix3, Vector3};

/// Arrays of the rotors' motion, with entries by joint.
pub(super) struct Rotors {
    /// Momentum h = i J a of a rotor per unit of its joint's velocity, with the gear ratio i, axial inertia J
    /// and axis a.
    momentum: ArrayId,
    /// Vector ω × h with the angular velocity ω of the body that carries the rotor. h is the rotor's momentum
    /// per unit of the joint's velocity.
    swept: ArrayId,
    /// Momentum ẏ h of the rotor's spin, with the joint's velocity ẏ and the rotor's momentum h per unit of
    /// this velocity.
    spin: ArrayId,
}

impl Rotors {
    /// Adds the arrays of the rotors' motion; `None` if no moving body carries a rotor.
    pub fn new(builder: &mut ArrayBuilder, setup: &Setup, motions: &Motions) -> Option<Self> {
        let momentum = setup.momenta?;
        let [swept, spin] = builder.map(
            "rotors_in_motion",
            "Motion of the rotors with the bodies before the joints, and the rotors' spin.",
            &[momentum, motions.velocity, motions.joint_velocity, setup.rates],
            [("swept_rotor", 3), ("rotor_spin", 3)],
            |[momentum, velocity, own, rate]| {
                let carrier = motion_of(velocity).angular - motion_of(own).angular;
                let swept = carrier.cross(vector(momentum));
                [swept, vector(momentum).scaled(rate[0])].map(|v| v.0.to_vec())
            },
        );
        Some(Self { momentum, swept, spin })
    }

    /// Moments `ÿ h + ẏ ω × h` on the bodies that carry rotors, by joint. h is the rotor's momentum per unit
    /// of its joint's velocity ẏ, and ω the body's angular velocity.
    pub fn moments(&self, builder: &mut ArrayBuilder, setup: &Setup, accelerations: ArrayId) -> ArrayId {
        let [moments] = builder.map(
            "rotor_moments",
            "Moment of each joint's rotor on the body before the joint.",
            &[self.momentum, self.swept, setup.rates, accelerations],
            [("rotor_moment", 3)],
            |[momentum, swept, rate, acceleration]| {
                let moment = vector(momentum).scaled(acceleration[0]) + vector(swept).scaled(rate[0]);
                [moment.0.to_vec()]
            },
        );
        moments
    }

    /// Moments `ẏ ω × h` on the bodies that carry rotors at ÿ = 0, by joint. h is the rotor's momentum per
    /// unit of its joint's velocity ẏ, and ω the body's angular velocity.
    pub fn steady_moments(&self, builder: &mut ArrayBuilder, setup: &Setup) -> ArrayId {
        let [moments] = builder.map(
            "steady_rotor_moments",
            "Moment of each joint's rotor on the body before the joint, at ÿ = 0.",
            &[self.swept, setup.rates],
            [("rotor_moment", 3)],
            |[swept, rate]| [vector(swept).scaled(rate[0]).0.to_vec()],
        );
        moments
    }

    /// Part `ÿ h` of the rotors' moments on their carriers that the accelerations ÿ add, by joint. h is the
    /// rotor's momentum per unit of its joint's velocity.
    pub fn added_moments(&self, builder: &mut ArrayBuilder, accelerations: ArrayId) -> ArrayId {
        let [moments] = builder.map(
            "added_rotor_moments",
            "Moment of each joint's rotor on the body before the joint, by its acceleration.",
            &[self.momentum, accelerations],
            [("added_rotor_moment", 3)],
            |[momentum, acceleration]| [vector(momentum).scaled(acceleration[0]).0.to_vec()],
        );
        moments
    }

    /// Adds the moments of all rotors on bodies beyond each joint to the force on these bodies.
    pub fn add_moments(builder: &mut ArrayBuilder, force: ArrayId, moments: ArrayId) -> ArrayId {
        let sum = builder.sum_subtrees(moments, "composite_rotor_moment");
        let [force] = builder.map(
            "forces_with_rotors",
            "Force of all bodies beyond each joint, rotors included.",
            &[force, sum, moments],
            [("force_with_rotors", 6)],
            |[force, sum, own]| {
                let Force { moment, force } = force_of(force);
                let moment = moment + (vector(sum) - vector(own));
                [flat(Force { moment, force })]
            },
        );
        force
    }

    /// Adds the rotors to the force and the velocity moments of all bodies beyond each joint.
    pub fn complete(&self, builder: &mut ArrayBuilder, bodies: Composites, moments: ArrayId) -> Composites {
        let force = Self::add_moments(builder, bodies.force, moments);
        let sum = builder.sum_subtrees(self.spin, "composite_rotor_spin");
        let [flow] = builder.map(
            "flows_with_rotors",
            "Momentum of all bodies beyond each joint, rotors included.",
            &[bodies.flow, sum, self.spin],
            [("flow_with_rotors", 12)],
            |[flow, sum, own]| {
                let spin = Matrix3::cross(vector(sum) - vector(own)).0.concat();
                let spin = flow[3..].iter().zip(spin).map(|(&bodies, rotors)| bodies + rotors);
                [flow[..3].iter().copied().chain(spin).collect()]
            },
        );
        Composites { force, flow, ..bodies }
    }

    /// Forces `h · ω̇` at the joints that turn rotors, caused by the angular accelerations ω̇ of the rotors'
    /// carriers. h is the rotor's momentum per unit of the joint's velocity.
    pub fn carried(&self, builder: &mut ArrayBuilder, motions: &Motions) -> ArrayId {
        let [carried] = builder.map(
            "carried_rotors",
            "Force on each joint by the acceleration of the body that carries its rotor.",
            &[self.momentum, motions.acceleration, motions.joint_acceleration],
            [("carried_rotor", 1)],
            |[momentum, acceleration, own]| {
                let carrier = motion_of(acceleration).angular - motion_of(own).angular;
                [vec![vector(momentum).dot(carrier)]]
            },
        );
        carried
    }

    /// Adds the rotor's momentum per unit of the joint's velocity to the moment that a unit acceleration of
    /// this joint requires at the joints before it.
    pub fn add_momentum(&self, builder: &mut ArrayBuilder, needed: ArrayId) -> ArrayId {
        let [needed] = builder.map(
            "unit_accelerations_with_rotors",
            "Forces for a unit acceleration of each joint and its rotor.",
            &[needed, self.momentum],
            [("unit_force_with_rotors", 6)],
            |[needed, momentum]| [flat(with_moment(force_of(needed), vector(momentum)))],
        );
        needed
    }

    /// Adds the rotors to the columns of the Jacobians: `ω × h` to the effect of δω, `h` to the effect of
    /// δω̇, and `ω × h` to the damping. h is the rotor's momentum per unit of its joint's velocity, and ω the
    /// carrier's angular velocity.
    pub fn add_to_columns(
        &self,
        builder: &mut ArrayBuilder,
        gains: ArrayId,
        damping: ArrayId,
    ) -> (ArrayId, ArrayId) {
        let [gains, damping] = builder.map(
            "disturbances_with_rotors",
            "Effect of the joints before each joint on it and its rotor.",
            &[gains, damping, self.momentum, self.swept],
            [("gains_with_rotors", 9), ("damping_with_rotors", 6)],
            |[gains, damping, momentum, swept]| {
                let by_omega = vector(gains) + vector(swept);
                let inertial = with_moment(force_of(&gains[3..]), vector(momentum));
                [
                    [&by_omega.0[..], &inertial.entries()].concat(),
                    flat(with_moment(force_of(damping), vector(swept))),
                ]
            },
        );
        (gains, damping)
    }
}

fn with_moment<'g>(f: Force<'g>, moment: Vector3<Scalar<'g>>) -> Force<'g> {
    Force { moment: f.moment + moment, ..f }
}

//! Motion of the robot as arrays over joints.

use super::bodies::{Composites, Motions, move_bodies};
use super::builder::ArrayBuilder;
use super::rotors::Rotors;
use super::rows::{flat, force_of, moments_of, motion_of};
use super::setup::Setup;
use crate::program::arrays::ArrayId;

/// Arrays over joints with the robot's motion and forces.
pub(super) struct Moving {
    pub setup: Setup,
    pub motions: Motions,
    /// Arrays of the rotors; `None` if no moving body carries a rotor.
    pub rotors: Option<Rotors>,
    /// Sums over all bodies beyond each joint, rotors included.
    pub composites: Composites,
}

/// Adds the motion and forces of all bodies. They include the given accelerations if `is_accelerated` is
/// true; otherwise ÿ is 0.
pub(super) fn set_moving(builder: &mut ArrayBuilder, setup: Setup, is_accelerated: bool) -> Moving {
    let (motions, flow) = move_bodies(builder, &setup, is_accelerated);
    let rotors = Rotors::new(builder, &setup, &motions);
    let force = if is_accelerated { "composite_force" } else { "composite_bias" };
    let mut composites = Composites {
        inertia: builder.sum_subtrees(motions.inertia, "composite_inertia"),
        flow: builder.sum_subtrees(flow, "composite_flow"),
        force: builder.sum_subtrees(motions.force, force),
    };
    if let Some(rotors) = &rotors {
        let moments = match is_accelerated {
            true => rotors.moments(builder, &setup, setup.last),
            false => rotors.steady_moments(builder, &setup),
        };
        composites = rotors.complete(builder, composites, moments);
    }
    Moving { setup, motions, rotors, composites }
}

/// Adds the accelerations of the joints to a motion that was computed at ÿ = 0.
pub(super) fn accelerate(builder: &mut ArrayBuilder, steady: Moving, accelerations: ArrayId) -> Moving {
    let Moving { setup, motions, rotors, composites } = steady;
    let [gained] = builder.map(
        "joint_accelerations",
        "Acceleration that each joint adds.",
        &[setup.screws, accelerations],
        [("added_joint_acceleration", 6)],
        |rows| [motion_of(rows[0]).scaled(rows[1][0]).entries().to_vec()],
    );
    let gained = builder.sum_ancestors(gained, "added_acceleration");
    let [acceleration, force] = builder.map(
        "accelerated_bodies",
        "Acceleration of each body, and the force for the added acceleration.",
        &[motions.inertia, motions.acceleration, gained],
        [("total_acceleration", 6), ("added_force", 6)],
        |rows| {
            let gained = motion_of(rows[2]);
            [(motion_of(rows[1]) + gained).entries().to_vec(), flat(moments_of(rows[0]).times(gained))]
        },
    );
    let added = builder.sum_subtrees(force, "composite_added_force");
    let [force] = builder.map(
        "total_forces",
        "Force of all bodies beyond each joint.",
        &[composites.force, added],
        [("composite_force", 6)],
        |rows| [flat(force_of(rows[0]) + force_of(rows[1]))],
    );
    let force = match &rotors {
        Some(rotors) => {
            let moments = rotors.added_moments(builder, accelerations);
            Rotors::add_moments(builder, force, moments)
        }
        None => force,
    };
    Moving {
        setup,
        motions: Motions { acceleration, ..motions },
        rotors,
        composites: Composites { force, ..composites },
    }
}

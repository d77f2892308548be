//! Joint reactions: the wrench that passes through each joint.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, matrix};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;
use crate::layout::Dimension;

/// Its row of the catalogue.
pub const QUANTITY: Quantity = Quantity {
    name: function_names::JOINT_WRENCHES,
    summary: "Wrenches that pass through the joints, from the parent side to the child, in motion.",
    equation: "(F_i, n_i) = Σ (m (c̈ − g), r × m (c̈ − g) + I ω̇ + ω × I ω) over the bodies beyond joint i",
    arguments: &[Coordinates, Velocities, Accelerations],
    results: &[(
        "wrenches",
        &[Dimension::Fixed, Dimension::Fixed],
        "row i = moving joint i: those of the coordinates in their order, then those that follow others \
         (`FOLLOWER_NAMES` where there are such names, else the first of `DEPENDENT_JOINT_NAMES`); force (N), then moment about the joint's origin (N m), in the joint's frame after \
         its motion: that of the link that it carries, or for a standard DH row the one before d, a and α",
    )],
    notes: &[
        "A row is all that the bodies beyond the joint receive from outside but gravity: bearing, gear, drive, spring, \
         friction and belt together, whatever way their forces take. Its component along the joint, F_a on the axis a of \
         a sliding joint, n_a about that of a turning one and n_a + pitch F_a of a helical one, is therefore the sum of \
         what the drive's gear (behind the inertia of its rotor), springs, friction and couplings exert at the joint in \
         this motion; the bearing bears the other components. Friction and drives are no arguments: they change the row \
         by changing ÿ alone.",
        "The masses are those described, not base parameters, which have the same generalized forces and other reactions. \
         Rotors with `coupling = \"body\"` count where they are carried, with the moment that turns their spin; the \
         inertia of `coupling = \"diagonal\"` has no place and bears on no joint. The bodies on fixed and held joints \
         belong to the link that carries them; these joints have no rows.",
        "Newton–Euler equations in link frames (Luh, Walker and Paul 1980).",
    ],
    build: |equations, Arguments { y, v, a, .. }| {
        vec![matrix(equations.joint_wrenches(MotionInput { y, v, a }))]
    },
    ..Quantity::PLAIN
};

//! Joint reactions: the wrench that each joint transmits.

use super::quantity::Argument::{Accelerations, Coordinates, Velocities};
use super::quantity::{Quantity, matrix};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;
use crate::layout::Dimension;

/// The function `joint_wrenches` in the catalogue.
pub const QUANTITY: Quantity = Quantity {
    name: function_names::JOINT_WRENCHES,
    summary: "Joint wrenches: the wrench that each joint transmits from its parent side to its child side.",
    equation: "(F_i, n_i) = Σ (m (c̈ − g), r × m (c̈ − g) + I ω̇ + ω × I ω) over the bodies beyond joint i",
    arguments: &[Coordinates, Velocities, Accelerations],
    results: &[(
        "wrenches",
        &[Dimension::Fixed, Dimension::Fixed],
        "row i = moving joint i: the joints of the coordinates in their order, then followers (in the order of \
         `FOLLOWER_NAMES` if it exists, otherwise first in `DEPENDENT_JOINT_NAMES`); force (N), then moment \
         about the joint's origin (N m), in the joint's frame after its motion: the frame of the carried link, \
         or for a standard DH row the frame before d, a and α",
    )],
    notes: &[
        "A row is the wrench of all external effects except gravity on the bodies beyond the joint: bearing, \
         gear, drive, spring, friction and belt. Its component along the joint is F_a for a sliding joint with \
         axis a, n_a for a turning joint, and n_a + pitch F_a for a helical joint. This component is the sum \
         of the forces of gear (after the rotor's inertia), springs, friction and couplings at the joint. The \
         bearing transmits the other components. Friction and drives are not arguments, and affect the row only \
         through ÿ.",
        "The masses are those of the description. Base parameters would give the same generalized forces but \
         different wrenches. Rotors with `coupling = \"body\"` act on their carrier, including the gyroscopic moment. \
         The inertia of `coupling = \"diagonal\"` has no location and acts on no joint. Bodies on fixed and \
         held joints belong to the link that carries them; fixed and held joints have no rows.",
        "Newton–Euler equations in link frames (Luh, Walker and Paul 1980).",
    ],
    build: |equations, Arguments { y, v, a, .. }| {
        vec![matrix(equations.joint_wrenches(MotionInput { y, v, a }))]
    },
    ..Quantity::PLAIN
};

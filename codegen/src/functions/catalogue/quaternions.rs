//! Catalogue texts of robots with spherical and floating joints.

use super::otherwise::{Otherwise, Robots};

/// Derivatives by positions are taken along small motions.
pub const ALONG: Otherwise = Otherwise {
    notes: &[
        "Column j of ∂/∂y is the derivative along ⊕: of `δ ↦ f(integrate(y, δ))` by δ_j at 0, with the velocities held in the \
         frames of their bodies.",
    ],
    ..Otherwise::of(Robots::Quaternions)
};

/// The velocities of a joint with a quaternion are one joint.
pub const ONE_ROW: Otherwise = Otherwise {
    notes: &["A spherical or floating joint has one row, in the place of its last velocity."],
    ..Otherwise::of(Robots::Quaternions)
};

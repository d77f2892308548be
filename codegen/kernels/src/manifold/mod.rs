//! Positions that are not velocities: joints whose attitude is a quaternion.
//!
//! `widths` are the numbers of position entries of the joints: 1 (anything with ẏ = v), 4 (spherical: a quaternion x, y,
//! z, w), 7 (floating: position in the parent's frame, then the quaternion). Their velocities are 1, 3 (angular) and 6
//! (linear, then angular) numbers, in the body's own frame. Entries of positions y and of velocities v stand in the
//! order of the joints. `y ⊕ d` is where a motion with the velocity d leads within one second, `X exp(d)` on SE(3);
//! `y₂ ⊖ y₁` is its inverse. Derivatives by positions are taken along ⊕ (Solà, Deray and Atchuthan, A Micro Lie Theory
//! for State Estimation in Robotics, 2018).
//!
//! Quaternions are taken to be of unit length. The numbers of entries that `widths` gives must be NY and N: entries
//! beyond, and those of a width that is none of the three, are NaN.
//!
//! Texts and constraints are as in [`crate::discrete_time`], whose module takes the last three: they are
//! [`crate::discrete_time::runge_kutta_on_manifold`] and its neighbours.

use crate::math::{sin_cos, sqrt};

include!("joints.rs");
include!("rotation.rs");
include!("positions.rs");
include!("bracket.rs");
include!("tangents.rs");

/// A text, in the order in which they are pasted.
///
/// The first five make a module `manifold`, after `use super::math::{sin_cos, sqrt};` (for f32 their names there end in
/// `_f32`). The others stand after all those of [`crate::discrete_time::Text`] in the module `discrete_time`, after
/// [`Text::USED_IN_DISCRETE_TIME`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Text {
    /// Where the joints' entries stand.
    Joints,
    /// Exponential and logarithm of rotations.
    Rotation,
    /// [`integrate`], [`difference`], [`normalize`], [`neutral`]
    Positions,
    /// [`bracket`]
    Bracket,
    /// [`integrate_derivatives`], [`difference_derivatives`]
    Tangents,
    /// [`crate::discrete_time::runge_kutta_on_manifold`]
    RungeKutta,
    /// [`crate::discrete_time::runge_kutta_on_manifold_derivatives`]
    Sensitivities,
    /// [`crate::discrete_time::zero_order_hold_on_manifold`]
    ZeroOrderHold,
}

impl Text {
    /// What the texts in the module `discrete_time` take from the module `manifold` beside it.
    pub const USED_IN_DISCRETE_TIME: &str = "use super::manifold::{cross, integrate, places, pose_bracket, pose_tangents, read, rotation_tangents, write};";

    /// The Rust items.
    pub fn source(self) -> &'static str {
        match self {
            Self::Joints => include_str!("joints.rs"),
            Self::Rotation => include_str!("rotation.rs"),
            Self::Positions => include_str!("positions.rs"),
            Self::Bracket => include_str!("bracket.rs"),
            Self::Tangents => include_str!("tangents.rs"),
            Self::RungeKutta => include_str!("runge_kutta.rs"),
            Self::Sensitivities => include_str!("sensitivities.rs"),
            Self::ZeroOrderHold => include_str!("zero_order_hold.rs"),
        }
    }

    /// The same operations as C99, with `gelenk_` before every name; empty where C has no need of a text.
    ///
    /// They read the module's constants JOINT_POSITIONS, FIRST_POSITIONS and FIRST_VELOCITIES instead of `widths`, and hold
    /// nothing that the functions of a generated module do not call: compilers warn of it.
    pub fn c_source(self) -> &'static str {
        match self {
            // The constants of the module say where the entries stand; the bracket stands among the steps, its only callers.
            Self::Joints | Self::Bracket => "",
            Self::Rotation => include_str!("rotation.c"),
            Self::Positions => include_str!("positions.c"),
            Self::Tangents => include_str!("tangents.c"),
            Self::RungeKutta => include_str!("runge_kutta.c"),
            Self::Sensitivities => include_str!("sensitivities.c"),
            Self::ZeroOrderHold => include_str!("zero_order_hold.c"),
        }
    }
}

/// The bodies of functions in C99, as [`Text::c_source`].
pub mod c_bodies {
    /// [`super::integrate`]
    pub const INTEGRATE: &str = include_str!("integrate.c");
    /// [`super::difference`]
    pub const DIFFERENCE: &str = include_str!("difference.c");
    /// [`super::integrate_derivatives`]
    pub const INTEGRATE_DERIVATIVES: &str = include_str!("integrate_derivatives.c");
    /// [`super::normalize`]
    pub const NORMALIZE: &str = include_str!("normalize.c");
    /// Zero-order hold of the linearization.
    pub const DISCRETIZE: &str = include_str!("discretize.c");
    /// Runge–Kutta steps.
    pub const STEP: &str = include_str!("step.c");
    /// Runge–Kutta steps with their sensitivities.
    pub const STEP_DERIVATIVES: &str = include_str!("step_derivatives.c");
}

//! Positions of robots with quaternions, which do not form a vector space.
//!
//! `widths` contains the number of position entries of each joint:
//!
//! - 1 for a joint with one velocity, the rate of its position
//! - 4 for a spherical joint: a quaternion x, y, z, w
//! - 7 for a floating joint: position in the parent's frame, then the quaternion
//!
//! These joints have 1, 3 (angular) or 6 (linear, then angular) velocities in the frame of the moved body.
//! Entries of positions y and of velocities v have the order of the joints.
//!
//! The sum `y ⊕ d` is the position after a motion with the constant velocity d for one second, on SE(3)
//! `X exp(d)`. The difference `y₂ ⊖ y₁` is its inverse. Derivatives with respect to positions are taken along
//! ⊕ (Solà, Deray and Atchuthan, A Micro Lie Theory for State Estimation in Robotics, 2018).
//!
//! Quaternions must have unit length. NY and N must be the sums of position entries and velocities that
//! `widths` defines. Additional entries, and entries of joints with another width, are NaN.
//!
//! Texts and their restrictions are as in [`crate::discrete_time`]. The last three texts belong to that
//! module, for example [`crate::discrete_time::runge_kutta_on_manifold`].

use crate::math::{sin_cos, sqrt};

include!("joints.rs");
include!("rotation.rs");
include!("positions.rs");
include!("bracket.rs");
include!("tangents.rs");

/// Text about positions with quaternions that the generator pastes into modules. The variants have the order
/// in which the texts are pasted.
///
/// The first five texts form a module `manifold`, after `use super::math::{sin_cos, sqrt};` (in single
/// precision, the imported names end in `_f32`). The other texts belong to the module `discrete_time`. They
/// follow all texts of [`crate::discrete_time::Text`] and the imports of [`Text::USED_IN_DISCRETE_TIME`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Text {
    /// Text of the functions that find each joint's entries in the positions and velocities.
    Joints,
    /// Exponential and logarithm of rotations.
    Rotation,
    /// Text of [`integrate`] (`y ⊕ d`), [`difference`] (`y₂ ⊖ y₁`), [`normalize`] and [`neutral`], the
    /// positions without displacement.
    Positions,
    /// Text of [`bracket`], the Lie bracket of two velocities.
    Bracket,
    /// Text of [`integrate_derivatives`] and [`difference_derivatives`], the derivatives of `y ⊕ d` and
    /// `y₂ ⊖ y₁`.
    Tangents,
    /// Text of a Runge–Kutta step for robots with quaternions,
    /// [`crate::discrete_time::runge_kutta_on_manifold`].
    RungeKutta,
    /// Text of a Runge–Kutta step for robots with quaternions and of its derivatives,
    /// [`crate::discrete_time::runge_kutta_on_manifold_derivatives`].
    Sensitivities,
    /// Text of the exact discretization of a robot with quaternions,
    /// [`crate::discrete_time::zero_order_hold_on_manifold`].
    ZeroOrderHold,
}

impl Text {
    /// Items of the module `manifold` that the texts in the module `discrete_time` import.
    pub const USED_IN_DISCRETE_TIME: &str = "use super::manifold::{cross, integrate, places, pose_bracket, pose_tangents, read, rotation_tangents, write};";

    /// The Rust items of the text, as source code.
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

    /// The text in C99, with the same operations as in Rust. All names begin with `gelenk_`. Empty if C does
    /// not need the text.
    ///
    /// The texts read the module's constants JOINT_POSITIONS, FIRST_POSITIONS and FIRST_VELOCITIES instead of
    /// the argument `widths` of the Rust functions. They contain only functions that a generated module
    /// calls, because compilers warn about unused functions.
    pub fn c_source(self) -> &'static str {
        match self {
            // Constants of the module contain the indices of entries. The bracket is part of the text of the
            // steps, which alone call it.
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

/// C99 bodies of functions about positions with quaternions.
pub mod c_bodies {
    /// C99 body of [`super::integrate`]: the positions `y ⊕ d`.
    pub const INTEGRATE: &str = include_str!("integrate.c");
    /// C99 body of [`super::difference`]: the displacement `y₂ ⊖ y₁`.
    pub const DIFFERENCE: &str = include_str!("difference.c");
    /// C99 body of [`super::integrate_derivatives`]: the derivatives of `y ⊕ d`.
    pub const INTEGRATE_DERIVATIVES: &str = include_str!("integrate_derivatives.c");
    /// C99 body of [`super::normalize`]: unit length of all quaternions.
    pub const NORMALIZE: &str = include_str!("normalize.c");
    /// C99 body of `discretize` for robots with quaternions, the exact zero-order hold of the linearized
    /// robot.
    pub const DISCRETIZE: &str = include_str!("discretize.c");
    /// C99 body of `step` for robots with quaternions: Runge–Kutta steps over one sample time.
    pub const STEP: &str = include_str!("step.c");
    /// C99 body of `step_derivatives` for robots with quaternions: Runge–Kutta steps over one sample time,
    /// with their derivatives.
    pub const STEP_DERIVATIVES: &str = include_str!("step_derivatives.c");
}

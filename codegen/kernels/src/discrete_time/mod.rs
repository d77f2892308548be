//! Discrete time: exact zero-order hold of an affine system, and Runge–Kutta steps with their derivatives.
//!
//! The text of each file is compiled here and pasted into generated modules ([`Text`]). For single precision,
//! every `f64` in the text is replaced. The texts
//!
//! - use only `core`
//! - do not allocate or panic
//! - have only loops over N and M (the numbers of coordinates and inputs) or constants
//! - have no inner attributes or inner doc comments
//!
//! Robots with joints that have quaternions use the functions `…_on_manifold`, see [`crate::manifold`].
//!
//! `gelenk-runtime` calls this code for modules that were generated without these functions.

include!("sums.rs");
include!("halves.rs");
include!("zero_order_hold.rs");
include!("runge_kutta.rs");
include!("sensitivities.rs");

use crate::manifold::{
    cross, integrate, places, pose_bracket, pose_tangents, read, rotation_tangents, write,
};
include!("../manifold/runge_kutta.rs");
include!("../manifold/sensitivities.rs");
include!("../manifold/zero_order_hold.rs");

/// Parts of [`zero_order_hold`], for implementations of the same method over several systems at once.
pub mod shared {
    /// Largest number of doublings of the interval in the integral `Φ = ∫ exp(A s) ds`.
    pub const MOST_DOUBLINGS: u32 = super::MOST_DOUBLINGS;
    /// Number of terms in each of the three parts of the Taylor polynomial of `Φ = ∫ exp(A s) ds`.
    pub const TERMS: usize = super::TERMS;
    /// Coefficients `1/(k + 1)!` of the Taylor polynomial of `Φ = ∫ exp(A s) ds` for k = 0 … 17. The
    /// polynomial is evaluated in three parts with six successive powers each, which saves matrix products.
    pub const COEFFICIENTS: [[f64; TERMS]; 3] = super::COEFFICIENTS;

    /// Number of halvings of the period \[s\] after which the Taylor polynomial of `exp(A s)` is accurate;
    /// `None` if more halvings than [`MOST_DOUBLINGS`] are needed. `by_y` and `by_v` are the norms of `∂ÿ/∂y`
    /// and `∂ÿ/∂ẏ`.
    pub fn halvings(by_y: f64, by_v: f64, period: f64) -> Option<u32> {
        super::halvings(&[[by_y]], &[[by_v]], period)
    }
}

/// Text of discrete-time functions that the generator pastes into modules. The variants have the order in
/// which the texts are pasted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Text {
    /// Text of a function that adds a scaled array to a sum.
    Sums,
    /// Text of matrices over the state (y, ẏ), which are stored as upper and lower halves, and of their
    /// products.
    Halves,
    /// Text of [`zero_order_hold`], the exact discretization of an affine system.
    ZeroOrderHold,
    /// Text of [`runge_kutta`], an integration step of order 4.
    RungeKutta,
    /// Text of [`runge_kutta_derivatives`], an integration step with its derivatives.
    Sensitivities,
}

impl Text {
    /// The Rust items of the text, as source code.
    pub fn source(self) -> &'static str {
        match self {
            Self::Sums => include_str!("sums.rs"),
            Self::Halves => include_str!("halves.rs"),
            Self::ZeroOrderHold => include_str!("zero_order_hold.rs"),
            Self::RungeKutta => include_str!("runge_kutta.rs"),
            Self::Sensitivities => include_str!("sensitivities.rs"),
        }
    }

    /// The text in C99, with the same operations as in Rust. All names begin with `gelenk_`.
    pub fn c_source(self) -> &'static str {
        match self {
            // In C, these items are part of the text of the halves, which needs them.
            Self::Sums => "",
            Self::Halves => include_str!("halves.c"),
            Self::ZeroOrderHold => include_str!("zero_order_hold.c"),
            Self::RungeKutta => include_str!("runge_kutta.c"),
            Self::Sensitivities => include_str!("sensitivities.c"),
        }
    }
}

/// C99 function of the acceleration with its derivatives. It follows [`Text::Sensitivities`] for robots
/// without quaternions. Robots with quaternions use [`crate::manifold::Text::Sensitivities`] instead.
pub const C_ACCELERATION: &str = include_str!("acceleration.c");

/// C99 bodies of the functions `discretize`, `step` and `step_derivatives`.
///
/// [`crate::manifold::c_bodies`] contains the bodies for robots with quaternions.
pub mod c_bodies {
    /// C99 body of `discretize`, the exact zero-order hold of the linearized robot.
    pub const DISCRETIZE: &str = include_str!("discretize.c");
    /// C99 body of `step`: Runge–Kutta steps over one sample time.
    pub const STEP: &str = include_str!("step.c");
    /// C99 body of `step_derivatives`: Runge–Kutta steps over one sample time, with their derivatives.
    pub const STEP_DERIVATIVES: &str = include_str!("step_derivatives.c");
}

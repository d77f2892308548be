//! Access of the macro [`dynamics!`](crate::dynamics!) to functions that a module may not have.
//!
//! A macro cannot test whether a module has a function. Instead, the macro writes two nested blocks. The outer block imports
//! [`Missing`] under the name of the function. The inner block imports everything from the module. If the module has the
//! function, the compiler resolves the name to the function, otherwise to [`Missing`]. [`OrElse`] then calls the function or its
//! replacement.

use super::types::OfResults;

/// Represents a function that a module does not have.
#[derive(Debug, Clone, Copy)]
pub struct Missing;

/// Number of Runge–Kutta steps per period for modules without the constant `SUBSTEPS`.
pub const NO_SUBSTEPS: usize = 1;

/// A function of a module, or [`Missing`]. `A` is the type of its arguments, `R` the type of its result.
pub trait OrElse<A, R> {
    /// Result of the function, or of `otherwise` if the function is missing.
    fn or_else(&self, arguments: A, otherwise: impl FnOnce() -> R) -> R;
}

/// A function of a module, or [`Missing`], whose result is converted to a type `R` of the runtime. `A` is the
/// type of its arguments.
pub trait MadeOrElse<A, R> {
    /// Converts the result of the function, or calls `otherwise` if the function is missing.
    fn made_or_else(&self, arguments: A, otherwise: impl FnOnce() -> R) -> R;
}

impl<A, R> OrElse<A, R> for Missing {
    #[inline]
    fn or_else(&self, _: A, otherwise: impl FnOnce() -> R) -> R {
        otherwise()
    }
}

impl<A, R> MadeOrElse<A, R> for Missing {
    #[inline]
    fn made_or_else(&self, _: A, otherwise: impl FnOnce() -> R) -> R {
        otherwise()
    }
}

/// A function that a module must have, because it has no default.
///
/// ```compile_fail,E0277
/// mod arm {
///     // A module without its mass matrix.
///     pub use gelenk_generated::cart_pole::{
///         EFFORT_LIMITS, FRICTION_JUMPS, FUNCTIONS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, M, N, PEAK_EFFORT_LIMITS, PEAK_INPUT_LIMITS,
///         POSITION_LIMITS, VELOCITY_LIMITS, coriolis_forces, friction_torques, gravity_forces, input_matrix,
///         inverse_dynamics_derivatives, linearize, spring_forces,
///     };
/// }
/// gelenk_dynamics::dynamics!(struct Arm = arm);
/// ```
#[diagnostic::on_unimplemented(
    message = "the module does not have a function that `Dynamics` requires",
    label = "generate this module with the functions mass_matrix, coriolis_forces, gravity_forces, spring_forces, friction_torques and input_matrix",
    note = "if you do not choose functions (`--functions`, or `functions` in the description), the generator writes all functions"
)]
pub trait Required<A, T> {
    /// Result of the function.
    fn result(&self, arguments: A) -> T;
}

/// Implements the traits for functions with each number of arguments.
macro_rules! functions {
    ($($argument:ident: $type:ident),*) => {
        impl<F: Fn($($type),*) -> R, $($type,)* R> OrElse<($($type,)*), R> for F {
            #[inline]
            fn or_else(&self, ($($argument,)*): ($($type,)*), _: impl FnOnce() -> R) -> R {
                self($($argument),*)
            }
        }

        impl<F: Fn($($type),*) -> T, $($type,)* T, R: OfResults<T>> MadeOrElse<($($type,)*), R> for F {
            #[inline]
            fn made_or_else(&self, ($($argument,)*): ($($type,)*), _: impl FnOnce() -> R) -> R {
                R::of(self($($argument),*))
            }
        }

        impl<F: Fn($($type),*) -> T, $($type,)* T> Required<($($type,)*), T> for F {
            #[inline]
            fn result(&self, ($($argument,)*): ($($type,)*)) -> T {
                self($($argument),*)
            }
        }
    };
}

functions!();
functions!(a: A);
functions!(a: A, b: B);
functions!(a: A, b: B, c: C);
functions!(a: A, b: B, c: C, d: D);
functions!(a: A, b: B, c: C, d: D, e: E);

/// Whether the list `functions` of a module contains the function `name`.
#[must_use]
pub const fn has(functions: &[&str], name: &str) -> bool {
    let mut k = 0;
    while k < functions.len() {
        if is_same(functions[k].as_bytes(), name.as_bytes()) {
            return true;
        }
        k += 1;
    }
    false
}

const fn is_same(a: &[u8], b: &[u8]) -> bool {
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
}

/// Represents whether a module has the functions that a trait requires.
#[derive(Debug, Clone, Copy)]
pub struct HasDerivatives<const B: bool>;

/// Trait that is only implemented if a module has the functions that a trait requires.
///
/// ```compile_fail,E0277
/// mod arm {
///     // A module without its derivatives.
///     pub use gelenk_generated::cart_pole::{
///         EFFORT_LIMITS, FRICTION_JUMPS, INPUT_LIMITS, INPUT_NAMES, JOINT_NAMES, M, N, PEAK_EFFORT_LIMITS, PEAK_INPUT_LIMITS,
///         POSITION_LIMITS, VELOCITY_LIMITS, coriolis_forces, friction_torques, gravity_forces, input_matrix, mass_matrix,
///         spring_forces,
///     };
///     pub const FUNCTIONS: [&str; 1] = ["mass_matrix"];
/// }
/// gelenk_dynamics::dynamics!(struct Arm = arm: Differentiable);
/// ```
///
/// Without `: Differentiable` in the list of traits, the macro also compiles for a module without
/// derivatives. Because of the lifetime, the compiler checks the bound only when the trait is used.
#[diagnostic::on_unimplemented(
    message = "the module does not have a derivative that `Differentiable` requires",
    label = "generate this module with the functions inverse_dynamics_derivatives and linearize",
    note = "if you do not choose functions (`--functions`, or `functions` in the description), the generator writes all functions"
)]
pub trait Yes<'a> {}

impl Yes<'_> for HasDerivatives<true> {}

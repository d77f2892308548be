//! The message of [`dynamics!`](crate::dynamics!) where free parameters were forgotten.

/// The trait of the type that stands in for `Parameters` in a module without free parameters.
#[diagnostic::on_unimplemented(
    message = "the module has free parameters, which the type has to hold",
    label = "write `struct Name {{ parameters }} = module`"
)]
pub trait NoFreeParameters {}

impl NoFreeParameters for () {}

/// Compiles where a module has no free parameters.
#[doc(hidden)]
pub const fn without_parameters<P: NoFreeParameters>() {}

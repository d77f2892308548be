//! Error message of [`dynamics!`](crate::dynamics!) for a type without its free parameters.

/// Trait of the type that replaces `Parameters` in a module without free parameters.
#[diagnostic::on_unimplemented(
    message = "the module has free parameters, so the type needs a field for them",
    label = "write `struct Name {{ parameters }} = module`"
)]
pub trait NoFreeParameters {}

impl NoFreeParameters for () {}

/// Compiles only for a module without free parameters. The macro [`dynamics!`](crate::dynamics!) calls this function, so that a
/// module with free parameters needs a field for their values.
#[doc(hidden)]
pub const fn without_parameters<P: NoFreeParameters>() {}

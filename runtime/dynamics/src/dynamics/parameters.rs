//! Error message of [`dynamics!`](crate::dynamics!) for a type without its free parameters.

/// Trait of the type that replaces `Parameters` in a module without free parameters.
#[diagnostic::on_unimplemented(
    message = "the module has free parameters, so the type needs a field for them",
    label = "write `struct Name {{ parameters }} = module`"
)]
pub trait NoFreeParameters {}

impl NoFreeParameters for () {}

/// A call compiles only if the module has no free parameters. The macro [`dynamics!`](crate::dynamics!) uses it to require a
/// field for them.
#[doc(hidden)]
pub const fn without_parameters<P: NoFreeParameters>() {}

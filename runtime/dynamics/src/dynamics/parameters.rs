//! What [`dynamics!`](crate::dynamics!) says where free parameters were forgotten.

/// What a module without free parameters has in the place of them.
#[diagnostic::on_unimplemented(
    message = "the module has free parameters, which the type has to hold",
    label = "write `struct Name {{ parameters }} = module`"
)]
pub trait NoFreeParameters {}

impl NoFreeParameters for () {}

/// Compiles where a module has no free parameters.
#[doc(hidden)]
pub const fn without_parameters<P: NoFreeParameters>() {}

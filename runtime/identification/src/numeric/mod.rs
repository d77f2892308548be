//! Functions on numbers and arrays.

pub(crate) mod kernel;
pub(crate) mod levels;
pub(crate) mod random;
pub(crate) mod shifted;
pub(crate) mod spectrum;
pub(crate) mod statistics;

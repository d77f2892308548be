//! Small helpers on numbers and arrays.

pub mod digits;
pub(crate) mod kernel;
pub mod random;
pub(crate) mod shifted;
pub(crate) mod spectrum;
pub(crate) mod statistics;

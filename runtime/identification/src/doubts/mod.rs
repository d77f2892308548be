//! Findings about data and friction laws that need more than one stage of the identification.

pub(crate) mod levels;
pub(crate) mod limits;
pub(crate) mod written;

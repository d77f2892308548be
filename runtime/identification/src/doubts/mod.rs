//! Doubts about data and laws that need more than one stage of the identification.

pub(crate) mod range;
pub(crate) mod written;

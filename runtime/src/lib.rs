//! Control and identification of generated robots.

pub mod dynamics;
pub mod identification;

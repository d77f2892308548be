//! Control and identification of generated robots.

pub mod qp;

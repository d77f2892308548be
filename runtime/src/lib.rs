//! Control and identification of generated robots.

pub mod lqr;
pub mod qp;

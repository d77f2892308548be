//! Control and identification of generated robots.

pub mod control_loop;
pub mod dynamics;
pub mod identification;
pub mod lanes;
pub mod lqr;
pub mod qp;

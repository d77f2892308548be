//! Control and identification of generated robots.
//!
//! The features `control`, `identification` and `report` are all on by default. A module of the first two stands behind
//! its feature: what the program `gelenk` builds, `report` alone, must compile without them.

#[cfg(feature = "control")]
pub mod control_loop;
pub mod dynamics;
#[cfg(feature = "control")]
pub mod feed_forward;
#[cfg(any(feature = "identification", feature = "report"))]
pub mod file;
#[cfg(feature = "identification")]
pub mod identification;
#[cfg(feature = "control")]
pub mod kinematics;
#[cfg(feature = "control")]
pub mod lanes;
#[cfg(feature = "control")]
pub mod lqr;
#[cfg(feature = "control")]
pub mod mpc;
#[cfg(feature = "control")]
pub mod plant;
#[cfg(feature = "control")]
pub mod qp;
#[cfg(any(feature = "identification", feature = "report"))]
#[cfg_attr(
    not(feature = "identification"),
    allow(dead_code, reason = "the text of a module that the generator has too")
)]
mod replace;
#[cfg(feature = "report")]
pub mod report;
#[cfg(feature = "control")]
pub mod trajectory;
#[cfg(feature = "control")]
pub mod transport;

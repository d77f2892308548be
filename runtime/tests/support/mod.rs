//! Shared parts of test binaries: random optimal-control QPs with Clarabel as their oracle, their KKT
//! conditions, a robot with its loop, its plant process, programs of examples.
#![allow(dead_code, reason = "each test binary uses its own part")]
#![allow(clippy::unwrap_used, reason = "test code: a problem that cannot be set up ends the test")]

pub mod data;
pub mod example;
pub mod kkt;
pub mod learning;
pub mod mixed;
pub mod named_robot;
pub mod oracle;
pub mod plant_process;
pub mod quadrotor;
pub mod random_qp;
pub mod random_rows;
pub mod robot;
pub mod rubbing;
pub mod tied_qp;
pub mod tracking;
pub mod wide_qp;
pub mod worth;

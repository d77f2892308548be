//! Random optimal-control QPs, and Clarabel as their oracle.
#![allow(dead_code, reason = "each test binary uses its own part")]
#![allow(
    clippy::unwrap_used,
    reason = "test code: a problem that cannot be set up ends the test"
)]

pub mod oracle;
pub mod random_qp;

//! Random optimal-control QPs, and Clarabel as their oracle.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub mod oracle;
pub mod random_qp;

//! The QP underneath the MPC: a Riccati-factorized interior-point method.

mod barrier;
mod interior_point;
mod lanes;
mod problem;
pub(crate) mod riccati;
mod solver;
mod status;
pub(crate) mod trajectory;

pub use problem::{Penalty, QpProblem, QpStage};
pub use solver::{MAX_HORIZON, MAX_SIZE, QpSolver};
pub use status::{KktResiduals, QpError, QpReport, QpSettings, QpStatus};

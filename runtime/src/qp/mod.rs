//! The QP underneath the MPC: a Riccati-factorized interior-point method.
//!
//! [`QpProblem`] is plain data, [`QpSolver`] the method with its memory, [`QpReport`] what came of it. Inside, from the paper to the arithmetic:
//!
//! | module | holds |
//! |---|---|
//! | `interior_point` | Mehrotra's predictor–corrector iteration, starts, safeguards, the relaxed problem |
//! | `barrier` | bounds, hard and soft: slacks, multipliers, their Newton steps |
//! | `riccati` | the factorization of the Newton system stage by stage, and its sweeps |
//! | `trajectory`, `lanes` | memory layout, and vectors of four numbers |
//!
//! Every iterate satisfies the dynamics, and inputs returned satisfy their bounds exactly. Hard state bounds out of reach are found out within a
//! bounded number of iterations, and replaced by exact penalties ([`QpStatus::Relaxed`]).

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

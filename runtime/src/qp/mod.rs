//! The QP underneath the MPC: a Riccati-factorized interior-point method.
//!
//! [`QpProblem`] is plain data, [`QpSolver`] the method with its memory, [`QpReport`] the result.
//! Inside, from the paper to the arithmetic:
//!
//! | module | holds |
//! |---|---|
//! | `interior_point` | Mehrotra's predictor–corrector iteration, starts, safeguards, the relaxed problem |
//! | `interior_point::follow` | warm starts: Newton's method from the active set of the last solution |
//! | `interior_point::augmented` | the method of multipliers, for what the iteration has not solved |
//! | `pause` | which problems Newton's method is not tried on after failures |
//! | `certify`, `certificate` | cost and residuals of the point returned, from which the status follows |
//! | `barrier`, `multipliers` | bounds, hard and soft: slacks, multipliers, their Newton steps |
//! | `equality` | bounds that are equal: fixed inputs, states that must pass through a point |
//! | `rows` | rows `lo ≤ C x + D u ≤ hi`: values that follow from x and u, bounded as states are |
//! | `core`, `solver` | memory and loading of a problem; the public face, which chooses the lanes |
//! | `riccati`, `sweeps` | the factorization of the Newton system stage by stage, and its solutions |
//! | `kernels`, `ldl` | matrix products in registers, small factorizations |
//! | `trajectory`, `lanes`, `avx2` | memory layout, and vectors of four numbers |
//!
//! Every iterate satisfies the dynamics, and inputs returned satisfy their bounds exactly. Hard state bounds
//! and rows out of reach are found out within a bounded number of iterations, and replaced by exact penalties
//! ([`QpStatus::Relaxed`]).

#[cfg(all(target_arch = "x86_64", feature = "std"))]
pub(crate) mod avx2;
mod barrier;
mod certificate;
mod certify;
mod core;
mod equality;
mod interior_point;
mod kernels;
pub(crate) mod lanes;
mod ldl;
mod multipliers;
mod pause;
mod problem;
pub(crate) mod riccati;
mod rows;
mod solver;
mod status;
mod sweeps;
pub(crate) mod trajectory;

pub use problem::{Penalty, QpProblem, QpRows, QpStage};
pub use solver::{MAX_HORIZON, MAX_SIZE, QpSolver};
pub use status::{KktResiduals, QpError, QpReport, QpSettings, QpStatus};

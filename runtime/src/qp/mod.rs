//! Interior-point solver with Riccati factorization for the quadratic programs (QPs) of the predictive controllers.
//!
//! [`QpProblem`] contains the data of a problem, [`QpSolver`] contains the method and its memory, and [`QpReport`] is
//! the result. The private modules are:
//!
//! | module | content |
//! |---|---|
//! | `interior_point` | Mehrotra's predictor–corrector iteration, starting points, safeguards, the relaxed problem |
//! | `interior_point::follow` | warm starts: Newton's method from the active set of the last solution |
//! | `interior_point::augmented` | the method of multipliers, for problems that the iteration does not solve |
//! | `pause` | number of problems without Newton's method after failures |
//! | `certify`, `certificate` | cost and residuals of the returned point, which decide its status |
//! | `barrier`, `multipliers` | hard and soft bounds: slacks, multipliers and their Newton steps |
//! | `equality` | equal bounds: fixed inputs, and states that must pass through a point |
//! | `rows` | rows `lo ≤ C x + D u ≤ hi`: values that depend on x and u and have bounds like states |
//! | `core`, `solver` | memory and loading of a problem; the public interface, which selects the vector instructions |
//! | `riccati`, `sweeps` | factorization of the Newton system stage by stage, and its solutions |
//! | `kernels`, `ldl` | matrix products in registers, small factorizations |
//! | `trajectory`, `lanes`, `x86` | memory layout, and vectors of four or eight numbers (lanes) |
//!
//! Every iterate satisfies the dynamics, and the returned inputs satisfy their bounds exactly. If hard state bounds or
//! rows cannot be kept, the solver detects this within a bounded number of iterations. It then replaces these bounds and
//! rows by exact penalties ([`QpStatus::Relaxed`]).

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
#[cfg(all(target_arch = "x86_64", feature = "std"))]
pub(crate) mod x86;

pub use problem::{Penalty, QpProblem, QpRows, QpStage};
pub use solver::{MAX_HORIZON, MAX_SIZE, QpSolver};
pub use status::{KktResiduals, QpError, QpReport, QpSettings, QpStatus};

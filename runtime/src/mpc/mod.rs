//! Model predictive control along a trajectory: linear time-varying ([`LtvMpc`]) and nonlinear ([`Nmpc`]).
//!
//! Both are feedback on top of the feed-forward: with δx = x − x_ref and δu = u + d − u_ff they minimize over
//! a horizon of `K` periods `T`
//!
//! ```text
//!     Σ_{k=1}^{K−1} ½ δx_kᵀ Q δx_k + ½ δx_Kᵀ P δx_K + Σ_{k=0}^{K−1} ½ δu_kᵀ R δu_k + ½ ((u_k − u_{k−1})/T)ᵀ W ((u_k − u_{k−1})/T)
//!     s.t. x_{k+1} = A_k x_k + B_k (u_k + d) + c_k,   u_min ≤ u_k ≤ u_max (hard),   y and ẏ within their limits (soft, exact penalty)
//! ```
//!
//! with P from the discrete Riccati equation, with a discount where no input reaches a part of the robot
//! ([`TerminalWeight`]), and d the input disturbance that a Kalman filter estimates from
//! the encoders ([`DisturbanceObserver`]), on by default, so that constant errors of the model leave no steady offset. The
//! two differ in where `A_k, B_k, c_k` come from: the exact zero-order hold of the linearization around the
//! desired trajectory or the previous plan, or there a step of the implicit midpoint rule ([`PredictionRule`]); or the exact sensitivities of the integrated nonlinear robot
//! around the plan, one Gauss–Newton step a period.
//!
//! The exact holds of a horizon around the plan are computed four stages at a time ([`ZeroOrderHolds`](crate::lanes::ZeroOrderHolds)), and so is the
//! linearization of a module with `linearize` over lanes (`lanes = ["linearize"]` in its description). The last digits of a
//! prediction then depend on the neighbouring stages around the plan, and on whether the processor has AVX2 with fused multiply-add.
//!
//! Sums of positions, velocities and inputs have limits too, hard or soft ([`MpcRow`]): a motor's torque–speed
//! line `|u + c ẏ| ≤ U`, a joint that follows others. [`MpcOptions::with_rows`] adds them; without rows nothing
//! is computed for them.
//!
//! The QP of a period starts from the solution of the last one, moved by the periods since then
//! ([`QpSolver::solve_warm`](crate::qp::QpSolver::solve_warm)): most need one to five factorizations. The first one
//! starts cold.
//!
//! A computed input that acts one period late is compensated ([`MpcOptions::delay`]): the horizon then begins
//! where the input under way will have led.
//!
//! Where the trajectory is beyond the soft limits or a row, friction jumps at rest, or a terminal weight has few
//! digits, the controller says so when it is made ([`LtvMpc::notes`]): print its notes before the first
//! motion. [`tune`] is the guide to weights and limits.
//!
//! Of robots with quaternions δx is the error state (y ⊖ y_ref, v − v_ref), `2 N` numbers, and the predictions are
//! derivatives of `y⁺ ⊖ y_ref⁺` by `y ⊖ y_ref`. Positions of joints with a quaternion have neither limits nor rows.
//! The reference must stay within half a turn of the robot: beyond, the shortest way turns round.
//!
//! Nothing is allocated after construction. A state has `NX = 2 N` numbers, positions before velocities; `NX`
//! is a parameter of its own because `2 N` is not a type on stable Rust; `dynamics!` supplies it
//! ([`PhaseSpace`](crate::dynamics::PhaseSpace)). Code that is generic over the model asks for
//! [`Predictable`](crate::dynamics::Predictable).
//!
//! Sources: the controller's structure follows Fehr, Schmid, Schneider, Eberhard, *Proc. Appl. Math. Mech.*
//! 20 (2020) (feed-forward and LTV-MPC on the PowerCube); offset-free tracking Pannocchia, Rawlings, *AIChE
//! J.* 49 (2003); multiple shooting and real-time iterations Diehl, Bock, Schlöder, *SIAM J. Control Optim.*
//! 43 (2005).

mod delegation;
mod error;
mod horizon;
mod integrate;
mod linear;
mod margins;
mod node;
mod nonlinear;
mod note;
mod observer;
mod options;
mod reference;
mod row;
#[doc = include_str!("tune.md")]
pub mod tune {}

pub use error::MpcError;
pub use linear::LtvMpc;
pub use nonlinear::Nmpc;
pub use note::MpcNote;
pub use observer::{DisturbanceObserver, ObserverOptions};
pub use options::{LinearizationPoint, MpcOptions, PredictionRule, TerminalWeight};
pub use row::{MpcRow, RowFault, RowKind};

//! Model predictive control along a trajectory: linear time-varying ([`LtvMpc`]) and nonlinear ([`Nmpc`]).
//!
//! Both controllers add a feedback to the feed-forward. In each period of length T they solve a quadratic program
//! (QP) over a horizon of `K` periods:
//!
//! ```text
//!     Σ_{k=1}^{K−1} ½ δx_kᵀ Q δx_k + ½ δx_Kᵀ P δx_K + Σ_{k=0}^{K−1} ½ δu_kᵀ R δu_k + ½ ((u_k − u_{k−1})/T)ᵀ W ((u_k − u_{k−1})/T)
//!     s.t. x_{k+1} = A_k x_k + B_k (u_k + d) + c_k,   u_min ≤ u_k ≤ u_max (hard),   y and ẏ within their limits (soft, exact penalty)
//! ```
//!
//! | symbol | meaning |
//! |---|---|
//! | x = (y, ẏ), u | state and inputs |
//! | d | input disturbance, estimated from the encoders by a Kalman filter ([`DisturbanceObserver`]) |
//! | x_ref, u_ff | desired state and feed-forward |
//! | δx, δu | deviations x − x_ref and u + d − u_ff |
//! | Q, R, W | weights of states, inputs and input rates, see [`MpcOptions`] |
//! | P | terminal weight, the solution of the discrete Riccati equation |
//!
//! The estimation of d is on by default, so constant model errors cause no steady-state offset. For robots with
//! parts that no input can move, [`TerminalWeight::Discounted`] discounts costs beyond the horizon.
//!
//! The prediction `A_k, B_k, c_k` depends on the controller:
//!
//! - [`LtvMpc`] linearizes the robot around the desired trajectory or the previous plan. It discretizes the
//!   linearization by the exact zero-order hold or by the implicit midpoint rule ([`PredictionRule`]).
//! - [`Nmpc`] uses the exact sensitivities of the nonlinear robot around the plan, and makes one Gauss–Newton step
//!   in each period.
//!
//! The zero-order holds of a horizon around the plan are computed four stages at a time
//! ([`ZeroOrderHolds`](crate::lanes::ZeroOrderHolds)). If the module has `linearize` for several states at once
//! (`lanes = ["linearize"]` in the description), several stages are also linearized at a time. The last digits of a
//! prediction around the plan then depend on the neighbouring stages, and on whether the processor has AVX2 with
//! fused multiply-add.
//!
//! Weighted sums of positions, velocities and inputs can have hard or soft limits too ([`MpcRow`]). Examples are the
//! torque–speed line `|u + c ẏ| ≤ U` of a motor, and the limits of a joint that follows other joints.
//! [`MpcOptions::with_rows`] adds such rows. A controller without rows needs no additional computing time.
//!
//! The QP of a period starts from the solution of the previous period, shifted by the time since then
//! ([`QpSolver::solve_warm`](crate::qp::QpSolver::solve_warm)). Most QPs need one to five factorizations. The
//! first QP has a cold start.
//!
//! A delay of one period between measurement and input can be compensated ([`MpcOptions::delay`]). The horizon then
//! begins one period later, at the state that the previously computed input leads to.
//!
//! The construction of a controller collects notes ([`LtvMpc::notes`]). Examples are a trajectory that
//! exceeds the soft limits or a row, friction that is discontinuous at rest, and an inaccurate terminal
//! weight. Print these notes before the first motion. [`tune`] is the guide to weights and limits.
//!
//! For robots with quaternions, δx is the error state (y ⊖ y_ref, v − v_ref) with `2 N` entries, and the
//! predictions are derivatives of `y⁺ ⊖ y_ref⁺` with respect to `y ⊖ y_ref`. Positions of joints with a
//! quaternion have neither limits nor rows. The attitude must stay within 180° of the reference: beyond 180°,
//! the shortest rotation to the reference has the opposite direction.
//!
//! Nothing is allocated after construction. A state has `NX = 2 N` entries, positions before velocities. `NX`
//! is a separate parameter because `2 N` is not a type on stable Rust. The macro `dynamics!` supplies `NX`
//! ([`PhaseSpace`](crate::dynamics::PhaseSpace)). Code that is generic over the model requires
//! [`Predictable`](crate::dynamics::Predictable).
//!
//! Sources: The structure of the controller (feed-forward and LTV-MPC on the PowerCube) follows Fehr, Schmid,
//! Schneider, Eberhard, *Proc. Appl. Math. Mech.* 20 (2020). Offset-free tracking is from Pannocchia,
//! Rawlings, *AIChE J.* 49 (2003). Multiple shooting and real-time iterations are from Diehl, Bock, Schlöder,
//! *SIAM J. Control Optim.* 43 (2005).

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

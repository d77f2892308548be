//! Discrete time: the exact zero-order hold of an affine system, and Runge–Kutta steps with their sensitivities.
//!
//! The files beside this one are those that the generator pastes into modules (codegen/src/discrete_time), for modules
//! that were generated without; `tests/tests/discrete_time.rs` holds the copies together.

include!("sums.rs");
include!("halves.rs");
include!("zero_order_hold.rs");
include!("runge_kutta.rs");
include!("sensitivities.rs");

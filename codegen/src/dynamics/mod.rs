//! Equations of motion over the expression graph. A formulation is one way to write the same equations; each
//! quantity is derived in the formulation with the fewest operations.
//!
//! `recursion` has the recursive equations over the bodies, and `search` chooses the formulations.
//! `per_joint` writes large functions as loops over joints. `parameters` has the regressors of inertial
//! parameters. `accelerations` has the forward dynamics. [`equations`] is the entry point.

mod accelerations;
pub mod arguments;
pub mod equations;
pub mod forces;
pub mod formulation;
pub mod frame_forces;
pub mod load_friction;
pub mod matrix;
pub mod momentum;
pub mod parameters;
pub mod per_joint;
pub mod recursion;
pub mod search;
pub mod tangent;

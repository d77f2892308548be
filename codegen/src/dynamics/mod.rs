//! Equations of motion as expressions of the graph. A formulation is one way to write the same equations.
//! Each quantity is derived in the formulation with the fewest operations.
//!
//! [`equations`] is the entry point. `accelerations` contains the forward dynamics, and `parameters` the
//! regressors of inertial parameters. `recursion` contains the recursive equations over the bodies, and
//! `search` chooses the formulations. `per_joint` writes large functions as loops over joints.

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

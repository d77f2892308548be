//! Stage 3: equations of motion over the graph; each quantity from its cheapest formulation.
//!
//! `recursion` has the equations over the bodies, `search` chooses their formulations, `per_joint` writes
//! large functions as loops over joints, and `parameters` has their linear parameters. [`equations`] is the
//! entry point; `accelerations` has the forward dynamics.

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

//! Stage 3: the equations of motion over the graph, each quantity from its cheapest formulation.
//!
//! `recursion` holds the equations over the bodies, `search` chooses among their forms, `per_joint` writes
//! the large ones as loops over joints, `parameters` knows what they are linear in, and [`equations`] is the
//! door, with what accelerates in `accelerations`.

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

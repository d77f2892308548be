//! Expression graphs. Equal nodes are stored once (hash-consing), and constants are folded at construction.
//! This module does not depend on robots.
//!
//! A [`Graph`] owns the nodes. A [`Scalar`] is a signed reference to a node. Therefore a negation is not an
//! operation, and `a − b` shares its node with `b − a`. Products of sums are not expanded, because rules may
//! only remove operations.

mod balance;
mod build;
mod cost;
mod differentiate;
mod node;
mod nodes;
mod scalar;

pub use balance::balanced;
pub use build::Graph;
pub use cost::Cost;
pub use differentiate::{differentiate, gradient, substitute};
pub use node::{Edge, Node};
pub use nodes::Nodes;
pub use scalar::Scalar;

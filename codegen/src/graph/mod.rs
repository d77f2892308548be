//! Expressions with sharing: hash-consed nodes, folded as they are built. There is no robot in here.
//!
//! A [`Graph`] owns the nodes; a [`Scalar`] is a signed reference to one, so that negation costs nothing and
//! `a − b` shares its node with `b − a`. Nothing is ever expanded: a rule fires only where it removes
//! operations.

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

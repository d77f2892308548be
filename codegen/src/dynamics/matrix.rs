//! Matrices of any size over the graph.

use crate::graph::Scalar;

/// A matrix over the graph, rows first.
pub type Matrix<'g> = Vec<Vec<Scalar<'g>>>;

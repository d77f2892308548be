//! Matrices of any size over the graph.

use crate::graph::{Graph, Scalar, differentiate};

/// A matrix over the graph, row-major.
pub type Matrix<'g> = Vec<Vec<Scalar<'g>>>;

/// Input array for auxiliary variables of differentiation; no function has it as an argument.
pub const FREE: usize = 1 << 20;

/// `∂ results / ∂ variables`, row i = result i.
pub fn jacobian<'g>(graph: &'g Graph, results: &[Scalar<'g>], variables: &[Scalar<'g>]) -> Matrix<'g> {
    let columns: Vec<_> = variables.iter().map(|&variable| differentiate(graph, results, variable)).collect();
    (0..results.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect()
}

/// `a + b`
pub fn sum<'g>(a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

/// `a − b`
pub fn subtract<'g>(a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// `a · b`
pub fn dot<'g>(graph: &'g Graph, a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Scalar<'g> {
    a.iter().zip(b).fold(graph.constant(0.0), |sum, (&a, &b)| sum + a * b)
}

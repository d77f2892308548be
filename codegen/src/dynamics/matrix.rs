//! Vectors and matrices of any size with expressions of the graph as entries.

use crate::graph::{Graph, Scalar, differentiate};

/// A matrix of expressions of the graph, as a list of rows.
pub type Matrix<'g> = Vec<Vec<Scalar<'g>>>;

/// Index of the input array for auxiliary variables of differentiation. This array is not an argument of any
/// function.
pub const FREE: usize = 1 << 20;

/// Jacobian ∂ results / ∂ variables. Row i belongs to result i.
pub fn jacobian<'g>(graph: &'g Graph, results: &[Scalar<'g>], variables: &[Scalar<'g>]) -> Matrix<'g> {
    let columns: Vec<_> = variables.iter().map(|&variable| differentiate(graph, results, variable)).collect();
    (0..results.len()).map(|row| columns.iter().map(|column| column[row]).collect()).collect()
}

/// Sum `a + b` of two vectors of equal length.
pub fn sum<'g>(a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a + b).collect()
}

/// Difference `a − b` of two vectors of equal length.
pub fn subtract<'g>(a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
    a.iter().zip(b).map(|(&a, &b)| a - b).collect()
}

/// Scalar product `a · b` of two vectors of equal length.
pub fn dot<'g>(graph: &'g Graph, a: &[Scalar<'g>], b: &[Scalar<'g>]) -> Scalar<'g> {
    a.iter().zip(b).fold(graph.constant(0.0), |sum, (&a, &b)| sum + a * b)
}

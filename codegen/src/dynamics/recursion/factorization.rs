//! Factorization `M = Lᵀ D L` of the mass matrix along the branches of the tree, and solution of `M x = b`
//! with the factors.
//!
//! Elimination from the leaves to the base keeps the zeros of M between branches (Featherstone 2005; 2008,
//! section 6.5).

use crate::graph::{Graph, Scalar};
use crate::kinematics::{Mechanism, Numbers};

/// Factors L and D of the mass matrix `M = Lᵀ D L`. Rows and columns have the order of the bodies with
/// independent joints.
#[derive(Debug, Clone)]
pub struct Factorization<'g> {
    /// Lower triangle L of `M = Lᵀ D L` with unit diagonal: `lower[i][j]` for each ancestor j of i.
    lower: Vec<Vec<Option<Scalar<'g>>>>,
    /// Reciprocals of the diagonal matrix D in `M = Lᵀ D L`.
    reciprocals: Vec<Scalar<'g>>,
    /// For each row of the factors, the earlier rows that the mass matrix couples with it; the nearest row is
    /// first.
    ancestors: Vec<Vec<usize>>,
    /// Coordinate to which each row of the factors belongs.
    coordinates: Vec<usize>,
}

impl<'g> Factorization<'g> {
    /// Factorizes a mass matrix. Its rows and columns have the order of the coordinates.
    pub fn new<S: Numbers>(mechanism: &Mechanism<S>, mass_matrix: &[Vec<Scalar<'g>>]) -> Self {
        let coordinates: Vec<_> = mechanism.independent().map(|body| body.joint).collect();
        let names: Vec<_> = mechanism.independent().map(|body| &body.identifier).collect();
        let count = coordinates.len();
        let couplings = couplings(&coordinates, mass_matrix);
        let mut work: Vec<Vec<Scalar<'g>>> = (0..count)
            .map(|i| (0..count).map(|j| mass_matrix[coordinates[i]][coordinates[j]]).collect())
            .collect();
        let mut lower = vec![vec![None; count]; count];
        let mut reciprocals = Vec::with_capacity(count);
        for k in (0..count).rev() {
            let one = work[k][k].constant(1.0);
            let reciprocal = one.divided_by(work[k][k]).named(|| format!("inverse_d_{}", names[k]));
            reciprocals.push(reciprocal);
            for &i in &couplings[k] {
                let factor = work[k][i] * reciprocal;
                for &j in couplings[k].iter().filter(|&&j| j <= i) {
                    work[i][j] = work[i][j] - factor * work[k][j];
                }
                lower[k][i] = Some(factor);
            }
        }
        reciprocals.reverse();
        Self { lower, reciprocals, ancestors: couplings, coordinates }
    }

    /// Inverse M⁻¹ of the mass matrix. Rows and columns have the order of the coordinates.
    pub fn inverse(&self, graph: &'g Graph) -> Vec<Vec<Scalar<'g>>> {
        let count = self.coordinates.len();
        let unit =
            |k: usize| (0..count).map(|i| graph.constant(if i == k { 1.0 } else { 0.0 })).collect::<Vec<_>>();
        let mut inverse: Vec<Vec<Scalar<'g>>> = (0..count).map(|k| self.solve(&unit(k))).collect();
        // The inverse is symmetric, so one triangle is copied.
        for i in 0..count {
            for j in 0..i {
                inverse[i][j] = inverse[j][i];
            }
        }
        inverse
    }

    /// Solution x of `M x = right` with the mass matrix M, by coordinate. For coordinates with prescribed
    /// motion, the entries are copied from `right`.
    pub fn solve(&self, right: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let mut x: Vec<_> = self.coordinates.iter().map(|&coordinate| right[coordinate]).collect();
        for i in (0..x.len()).rev() {
            for &j in &self.ancestors[i] {
                if let Some(factor) = self.lower[i][j] {
                    x[j] = x[j] - factor * x[i];
                }
            }
        }
        for (x, reciprocal) in x.iter_mut().zip(&self.reciprocals) {
            *x = *x * *reciprocal;
        }
        for i in 0..x.len() {
            for &j in &self.ancestors[i] {
                if let Some(factor) = self.lower[i][j] {
                    x[i] = x[i] - factor * x[j];
                }
            }
        }
        let mut solution = right.to_vec();
        for (index, &coordinate) in self.coordinates.iter().enumerate() {
            solution[coordinate] = x[index];
        }
        solution
    }
}

/// Lists, for each coordinate, the earlier coordinates with non-zero entries in the mass matrix; the nearest
/// coordinate is first. They are the ancestors, the coordinates of bodies that carry a rotor of another
/// branch, and coordinates that one joint follows together with this coordinate.
fn couplings(coordinates: &[usize], mass_matrix: &[Vec<Scalar<'_>>]) -> Vec<Vec<usize>> {
    let count = coordinates.len();
    let entry = |i: usize, j: usize| mass_matrix[coordinates[i]][coordinates[j]];
    let mut coupled: Vec<Vec<bool>> =
        (0..count).map(|i| (0..count).map(|j| j < i && !entry(i, j).is_zero()).collect()).collect();
    for k in (0..count).rev() {
        let before: Vec<_> = (0..k).filter(|&i| coupled[k][i]).collect();
        for (position, &i) in before.iter().enumerate() {
            for &j in &before[..position] {
                coupled[i][j] = true;
            }
        }
    }
    coupled.iter().map(|row| (0..count).rev().filter(|&j| row[j]).collect()).collect()
}

//! The smallest inputs that produce given joint forces, within limits if there are more inputs than joints.

use super::Instant;
use crate::numeric::spectrum::svd;
use crate::robot::Robot;
use nalgebra::{DMatrix, DVector, Dyn, SVD};

/// Largest error of a force of the inputs, as a share of the largest required force.
const RESIDUAL: f64 = 1e-9;
/// Singular values of the input matrix B below this share of the largest one count as zero, for example if a
/// cylinder is at its dead centre.
pub(super) const SINGULAR: f64 = 1e-9;
/// Number of corrections of the solution. The decomposition has an error of 6e-6 of the forces if columns of
/// the input matrix B differ much in size. Examples are columns of geared motors and of cylinders. Each
/// correction multiplies the error by 6e-6.
const CORRECTIONS: usize = 3;
/// Share of an input's range by which it may exceed its limits, for rounding near an end at 0.
const OUTSIDE: f64 = 1e-6;

/// The input matrix B and its singular value decomposition.
pub(super) struct SmallestInputs {
    matrix: DMatrix<f64>,
    decomposed: SVD<f64, Dyn, Dyn>,
}

impl SmallestInputs {
    pub(super) fn new(matrix: DMatrix<f64>) -> Self {
        let decomposed = svd(matrix.clone());
        Self { matrix, decomposed }
    }

    /// The smallest inputs u among those for which B u, with the input matrix B, is nearest to the forces;
    /// `None` if there are no inputs.
    pub(super) fn closest(&self, forces: &DVector<f64>) -> Option<DVector<f64>> {
        if self.matrix.is_empty() {
            return None;
        }
        let least = SINGULAR * self.decomposed.singular_values.max();
        let mut inputs = self.decomposed.solve(forces, least).ok()?;
        for _ in 0..CORRECTIONS {
            let rest = forces - &self.matrix * &inputs;
            inputs += self.decomposed.solve(&rest, least).ok()?;
        }
        Some(inputs)
    }

    /// The smallest inputs with exactly these forces; `None` if no inputs produce the forces.
    fn exact(&self, forces: &DVector<f64>) -> Option<DVector<f64>> {
        let inputs = self.closest(forces)?;
        let residual = (&self.matrix * &inputs - forces).amax();
        (residual <= RESIDUAL * forces.amax()).then_some(inputs)
    }
}

/// The forces that the described robot requires without friction.
pub(super) fn rigid_forces(robot: &dyn Robot, [y, v, a]: &Instant) -> DVector<f64> {
    let mut forces = DVector::zeros(v.len());
    robot.rigid_forces(y, v, a, forces.as_mut_slice());
    forces
}

/// The smallest inputs u with `B(y) u = M ÿ + k − q`; `None` if no inputs produce these forces. B is the
/// input matrix, M the mass matrix, k the bias force, and q the force without inputs.
///
/// If there are more inputs than joints, inputs that would leave their limits are held at the exceeded limit. For example, a
/// propeller that can only push stands still if it would have to pull. If the other inputs cannot produce the remaining
/// forces, the smallest inputs are returned, although they exceed limits.
pub(super) fn smallest_inputs(
    robot: &dyn Robot,
    matrix: &DMatrix<f64>,
    instant: &Instant,
    limits: &[[f64; 2]],
) -> Option<Vec<f64>> {
    let forces = rigid_forces(robot, instant);
    let smallest = SmallestInputs::new(matrix.clone()).exact(&forces)?;
    let is_redundant = matrix.ncols() > matrix.nrows();
    let within = is_redundant.then(|| held_within(matrix, &forces, smallest.clone(), limits)).flatten();
    Some(within.unwrap_or(smallest).as_slice().to_vec())
}

/// Holds one input after the other at an exceeded limit until all inputs are within their limits; `None` if the other inputs
/// cannot produce the forces.
fn held_within(
    matrix: &DMatrix<f64>,
    forces: &DVector<f64>,
    mut inputs: DVector<f64>,
    limits: &[[f64; 2]],
) -> Option<DVector<f64>> {
    let (mut free, mut rest) = (matrix.clone(), forces.clone());
    let mut held: Vec<Option<f64>> = vec![None; limits.len()];
    while let Some(input) = first_outside(inputs.as_slice(), limits) {
        if held[input].is_some() {
            return None;
        }
        let end = inputs[input].clamp(limits[input][0], limits[input][1]);
        held[input] = Some(end);
        rest -= matrix.column(input) * end;
        free.column_mut(input).fill(0.0);
        inputs = SmallestInputs::new(free.clone()).closest(&rest)?;
        for (value, end) in inputs.iter_mut().zip(&held) {
            *value = end.unwrap_or(*value);
        }
    }
    let residual = (matrix * &inputs - forces).amax();
    (residual <= RESIDUAL * forces.amax()).then_some(inputs)
}

/// Index of the first input that exceeds its limits by more than rounding; `None` if all inputs are within their limits.
pub(super) fn first_outside(inputs: &[f64], limits: &[[f64; 2]]) -> Option<usize> {
    let largest = inputs.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
    let is_outside = |(u, [low, high]): (&f64, &[f64; 2])| {
        let range = high - low;
        let slack = if range.is_finite() { OUTSIDE * range } else { RESIDUAL * largest };
        !(low - slack..=high + slack).contains(u)
    };
    inputs.iter().zip(limits).position(is_outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two geared motors at a differential, together with a cylinder with a lever of 0.21 m.
    #[test]
    fn geared_motors_beside_a_cylinder_have_their_forces() {
        for lever in [0.21, 0.37, -0.55, 1e-3] {
            let matrix = DMatrix::from_row_slice(3, 3, &[lever, 0., 0., 0., 80., 80., 0., 80., -60.]);
            let forces = DVector::from_row_slice(&[231.7, 1.31, -0.27]);
            let expected = matrix.clone().lu().solve(&forces).unwrap();
            let found = SmallestInputs::new(matrix).exact(&forces).unwrap();
            assert!((found - &expected).amax() < 1e-12 * expected.amax(), "{lever}");
        }
    }

    #[test]
    fn inputs_that_only_push_stand_still_where_they_would_pull() {
        let matrix = DMatrix::from_row_slice(2, 3, &[100., 0., 0.4, 0., 80., 0.2]);
        let limits = [[-1., 1.], [-1., 1.], [0., 20.]];
        let forces = DVector::from_row_slice(&[-30., -10.]);
        let smallest = SmallestInputs::new(matrix.clone()).exact(&forces).unwrap();
        assert_eq!(first_outside(smallest.as_slice(), &limits), Some(2));
        let found = held_within(&matrix, &forces, smallest, &limits).unwrap();
        assert!((found - DVector::from_row_slice(&[-0.3, -0.125, 0.])).amax() < 1e-15);
        let beyond = DVector::from_row_slice(&[-300., -10.]);
        let smallest = SmallestInputs::new(matrix.clone()).exact(&beyond).unwrap();
        assert_eq!(held_within(&matrix, &beyond, smallest, &limits), None);
    }
}

//! The convex program over bodies that can exist, as it is given.

use nalgebra::{DMatrix, DVector};

/// `minimize ½ xᵀ H x − gᵀ x` over bodies that can exist.
///
/// H has to be positive semidefinite. Where it vanishes (directions that neither data nor a regularization
/// determine) every value within the cones is a minimum: [`ConsistentSolution::open`](super::consistent::ConsistentSolution::open) counts the directions.
/// Bodies are then near one of a size that H suggests, entries behind them that H does not contain are zero.
/// Add [`super::regularized::towards`] to decide them with knowledge of the robot.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ConsistentProblem {
    /// H, `n × n`, symmetric.
    pub hessian: DMatrix<f64>,
    /// g, n entries.
    pub linear: DVector<f64>,
    /// Number of bodies: the first `10 · bodies` entries of x are their parameters.
    pub bodies: usize,
    /// Further entries which are not negative, e.g. rotor inertias and viscous friction.
    pub nonnegative: Vec<usize>,
}

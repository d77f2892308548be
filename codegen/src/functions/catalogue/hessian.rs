//! Hessian of the inverse dynamics weighted by multipliers λ. Its blocks belong to the constraint
//! `M ÿ + k − q = B u` in sequential quadratic programming with exact Hessians.
//!
//! The gradient of `λᵀ (M ÿ + k − q)` is computed either by reverse differentiation of the recursive
//! equations, or as the product of λ and the analytic Jacobians. Each column of the Hessian is a forward
//! derivative of the gradient.

use super::quantity::Argument::{Accelerations, Coordinates, Multipliers, Velocities};
use super::quantity::{Quantity, SQUARE, matrix};
use crate::dynamics::arguments::Arguments;
use crate::dynamics::equations::Equations;
use crate::dynamics::matrix::Matrix;
use crate::dynamics::matrix::dot;
use crate::dynamics::recursion::motion::MotionInput;
use crate::function_names;
use crate::graph::{Cost, Edge, Scalar, differentiate};

/// The function of the Hessian in the catalogue.
pub const QUANTITY: Quantity = Quantity {
    name: function_names::INVERSE_DYNAMICS_HESSIAN,
    differentiates_friction: true,
    summary: "Hessian of `λᵀ (M ÿ + k − q)`, for sequential quadratic programs with exact Hessians.",
    equation: "with (y, ẏ, ÿ): [[H_yy, H_yv, H_ya], [H_yvᵀ, H_vv, 0], [H_yaᵀ, 0, 0]]",
    arguments: &[Coordinates, Velocities, Accelerations, Multipliers],
    results: &[
        ("H_yy", SQUARE, "∂²/∂y², symmetric, both triangles filled"),
        ("H_yv", SQUARE, "∂²/∂y ∂ẏ, row i = coordinate i"),
        ("H_vv", SQUARE, "∂²/∂ẏ², symmetric, both triangles filled; friction included"),
        ("H_ya", SQUARE, "∂²/∂y ∂ÿ, row i = coordinate i: the derivative of M λ"),
    ],
    notes: &[
        "The constraint `M ÿ + k − q = B u` with multipliers λ adds these blocks to the Hessian of the \
         Lagrangian; the constraint is linear in u. The Hessian is the forward derivative of the gradient. The \
         gradient is computed by reverse differentiation of the inverse dynamics or as λ times the analytic \
         Jacobians, whichever needs fewer operations.",
    ],
    build: |equations, Arguments { y, v, a, lambda, .. }| {
        let hessian = inverse_dynamics_hessian(equations, MotionInput { y, v, a }, lambda);
        let blocks = [hessian.by_coordinates, hessian.mixed, hessian.by_velocities, hessian.by_accelerations];
        blocks.map(matrix).into()
    },
    ..Quantity::PLAIN
};

/// Blocks of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ. The blocks ∂²/∂ẏ ∂ÿ
/// and ∂²/∂ÿ² are zero.
#[derive(Debug, Clone)]
pub struct Hessian<'g> {
    /// Block ∂²/∂y² of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ.
    pub by_coordinates: Matrix<'g>,
    /// Block ∂²/∂y ∂ẏ of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ. Row i
    /// belongs to coordinate i.
    pub mixed: Matrix<'g>,
    /// Block ∂²/∂ẏ² of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ.
    pub by_velocities: Matrix<'g>,
    /// Block ∂²/∂y ∂ÿ of the Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with multipliers λ. Row i
    /// belongs to coordinate i.
    pub by_accelerations: Matrix<'g>,
}

impl<'g> Hessian<'g> {
    fn weight(&self, equations: &Equations<'_, 'g>) -> u64 {
        let blocks = [&self.by_coordinates, &self.mixed, &self.by_velocities, &self.by_accelerations];
        let edges: Vec<Edge> =
            blocks.iter().flat_map(|block| block.iter().flatten().map(|x| x.edge())).collect();
        Cost::of(equations.graph, &edges).weight()
    }
}

/// Hessian of the inverse dynamics `λᵀ (M ÿ + k − q)` with λ = `multipliers`. The gradient comes from reverse
/// differentiation or from the analytic Jacobians, whichever needs fewer operations.
pub fn inverse_dynamics_hessian<'g>(
    equations: &Equations<'_, 'g>,
    input: MotionInput<'_, 'g>,
    multipliers: &[Scalar<'g>],
) -> Hessian<'g> {
    let reverse = second(equations, input, reverse_gradient(equations, input, multipliers));
    let analytic = second(equations, input, analytic_gradient(equations, input, multipliers));
    match reverse.weight(equations) <= analytic.weight(equations) {
        true => reverse,
        false => analytic,
    }
}

/// Gradients of a scalar with respect to y and ẏ.
type Gradient<'g> = (Vec<Scalar<'g>>, Vec<Scalar<'g>>);

fn reverse_gradient<'g>(
    equations: &Equations<'_, 'g>,
    MotionInput { y, v, a }: MotionInput<'_, 'g>,
    multipliers: &[Scalar<'g>],
) -> Gradient<'g> {
    let forces = equations.inverse_dynamics(y, v, a);
    let work = dot(equations.graph, &forces, multipliers);
    equations.gradient_along(work, y, v)
}

fn analytic_gradient<'g>(
    equations: &Equations<'_, 'g>,
    input: MotionInput<'_, 'g>,
    multipliers: &[Scalar<'g>],
) -> Gradient<'g> {
    let derivatives = equations.inverse_dynamics_derivatives(input);
    let contract = |matrix: &Matrix<'g>| {
        let column = |j: usize| {
            let column: Vec<_> = matrix.iter().map(|row| row[j]).collect();
            dot(equations.graph, &column, multipliers)
        };
        (0..multipliers.len()).map(column).collect()
    };
    (contract(&derivatives.by_coordinates), contract(&derivatives.by_velocities))
}

fn second<'g>(
    equations: &Equations<'_, 'g>,
    MotionInput { y, v, a }: MotionInput<'_, 'g>,
    (mut by_y, mut by_v): Gradient<'g>,
) -> Hessian<'g> {
    let (graph, n) = (equations.graph, equations.model.coordinates.len());
    // Derivatives with respect to driven coordinates are not computed.
    by_y.truncate(n);
    by_v.truncate(n);
    let zeros = vec![vec![graph.constant(0.0); n]; n];
    let mut hessian = Hessian {
        by_coordinates: zeros.clone(),
        mixed: zeros.clone(),
        by_velocities: zeros.clone(),
        by_accelerations: zeros,
    };
    for j in 0..n {
        // The block is symmetric: entries from the diagonal on are used for both triangles.
        let later: Vec<_> = by_y[j..].iter().chain(&by_v).copied().collect();
        let column = equations.along(&later, y, j);
        let (own, mixed) = column.split_at(by_y.len() - j);
        for (i, &entry) in (j..).zip(own) {
            hessian.by_coordinates[i][j] = entry;
            hessian.by_coordinates[j][i] = entry;
        }
        equations.symmetrize_along(&mut hessian.by_coordinates, &by_y, y, j);
        hessian.mixed[j] = mixed.to_vec();
        for (i, entry) in (j..).zip(differentiate(graph, &by_v[j..], v[j])) {
            hessian.by_velocities[i][j] = entry;
            hessian.by_velocities[j][i] = entry;
        }
        for (row, entry) in differentiate(graph, &by_y, a[j]).into_iter().enumerate() {
            hessian.by_accelerations[row][j] = entry;
        }
    }
    hessian
}

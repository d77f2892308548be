//! Accelerations of a robot as expressions of the graph, with derivatives and the linearization.

use super::equations::Equations;
use super::load_friction;
use super::matrix::{FREE, Matrix, dot, subtract, sum};
use super::recursion::derivatives::ForceDerivatives;
use super::recursion::factorization::Factorization;
use super::recursion::motion::MotionInput;
use crate::graph::{Cost, Edge, Scalar};
use crate::spatial::Force;

/// Accelerations of n coordinates y with their derivatives.
#[derive(Debug, Clone)]
pub struct AccelerationDerivatives<'g> {
    /// Accelerations ÿ of the n coordinates.
    pub accelerations: Vec<Scalar<'g>>,
    /// Derivative ∂ÿ/∂y of the accelerations, n × n.
    pub by_coordinates: Matrix<'g>,
    /// Derivative ∂ÿ/∂ẏ of the accelerations, n × n.
    pub by_velocities: Matrix<'g>,
    /// Inverse mass matrix M⁻¹, n × n for n coordinates.
    pub inverse: Matrix<'g>,
}

/// Linearized accelerations `ÿ = A_y y + A_v ẏ + B_x u + c` with n coordinates y, their velocities ẏ and m
/// inputs u.
#[derive(Debug, Clone)]
pub struct AffineAccelerations<'g> {
    /// Matrix A_y = ∂ÿ/∂y of the linearization, n × n for n coordinates.
    pub by_coordinates: Matrix<'g>,
    /// Matrix A_v = ∂ÿ/∂ẏ of the linearization, n × n for n coordinates.
    pub by_velocities: Matrix<'g>,
    /// Matrix B_x = ∂ÿ/∂u of the linearization, n × m for n coordinates and m inputs.
    pub by_inputs: Matrix<'g>,
    /// Affine remainder c in `ÿ = A_y y + A_v ẏ + B_x u + c`, n entries.
    pub remainder: Vec<Scalar<'g>>,
}

/// Accelerations ÿ, the inverse mass matrix M⁻¹, and the required forces `f = M ÿ + k − q` with derivatives.
/// k are Coriolis forces, q applied forces. The derivatives of the accelerations are `∂ÿ = −M⁻¹ ∂f`, with ÿ
/// constant in f.
#[derive(Debug, Clone)]
pub struct AcceleratedForces<'g> {
    /// Accelerations ÿ of the n coordinates.
    pub accelerations: Vec<Scalar<'g>>,
    /// Inverse mass matrix M⁻¹, n × n for n coordinates.
    pub inverse: Matrix<'g>,
    /// Required forces `M ÿ + k − q` at the accelerations ÿ, with derivatives with respect to y and ẏ at
    /// constant ÿ. k are Coriolis forces, q applied forces.
    pub forces: ForceDerivatives<'g>,
}

impl<'g> Equations<'_, 'g> {
    /// Accelerations `ÿ = M⁻¹ (q + B u − k)` for the inputs u, with the applied forces q and the Coriolis
    /// forces k.
    pub fn forward_dynamics(&self, y: &[Scalar<'g>], v: &[Scalar<'g>], u: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let route = self.formulations.forward_dynamics();
        let input = MotionInput { y, v, a: &self.unaccelerated() };
        route.accelerations(self.graph, self.formulations, input, || self.driving_forces(y, v, u))
    }

    /// Accelerations `ÿ = M⁻¹ (q + B u + Σ Jᵀ w − k)` for the inputs u and wrenches w at frames with the
    /// Jacobians J. q are the applied forces, k the Coriolis forces.
    pub fn forward_dynamics_with_wrenches(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
        w: &[Force<'g>],
    ) -> Vec<Scalar<'g>> {
        let route = self.formulations.forward_dynamics();
        let driving = || sum(&self.driving_forces(y, v, u), &self.wrench_forces(y, w));
        let input = MotionInput { y, v, a: &self.unaccelerated() };
        route.accelerations(self.graph, self.formulations, input, driving)
    }

    /// Accelerations under the wrenches `w`, with derivatives with respect to y, to ẏ and to joint forces
    /// (the last derivative is M⁻¹).
    pub fn forward_dynamics_derivatives_with_wrenches(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
        w: &[Force<'g>],
    ) -> AccelerationDerivatives<'g> {
        self.acceleration_derivatives(y, v, u, Some(w))
    }

    /// Accelerations with derivatives with respect to y, to ẏ and to joint forces (the last derivative is
    /// M⁻¹).
    pub fn forward_dynamics_derivatives(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> AccelerationDerivatives<'g> {
        self.acceleration_derivatives(y, v, u, None)
    }

    /// Computes the accelerations ÿ, the inverse mass matrix M⁻¹, and the required forces `M ÿ + k − q` at
    /// these accelerations. Also returns the derivatives of the forces with respect to y and ẏ at constant ÿ.
    /// The robot must have no driven joints (with a prescribed motion).
    pub fn accelerated_forces(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> AcceleratedForces<'g> {
        let (mass, bias) = self.formulations.mass_and_bias_beside_derivatives();
        let factorization = Factorization::new(self.formulations.mechanism(), &self.mass_matrix_by(mass, y));
        let accelerating = subtract(&self.driving_forces(y, v, u), &self.bias_by(bias, y, v));
        let accelerations = factorization.solve(&accelerating);
        let input = MotionInput { y, v, a: &accelerations };
        let forces = self.remaining_derivatives(input, || self.driving_forces_by_motion(y, v, u));
        AcceleratedForces { accelerations, inverse: factorization.inverse(self.graph), forces }
    }

    fn acceleration_derivatives(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
        w: Option<&[Force<'g>]>,
    ) -> AccelerationDerivatives<'g> {
        let (mass, bias) = self.formulations.mass_and_bias_beside_derivatives();
        let matrix = self.mass_matrix_by(mass, y);
        let factorization = Factorization::new(self.formulations.mechanism(), &matrix);
        let inverse = factorization.inverse(self.graph);
        let wrenches = w.map(|w| self.wrench_forces_derivatives(y, w));
        let mut driving = self.driving_forces(y, v, u);
        if let Some((forces, _)) = &wrenches {
            driving = sum(&driving, forces);
        }
        let accelerating = subtract(&driving, &self.bias_by(bias, y, v));
        let by_inverse = self.weighs_less_by_inverse(&factorization, &inverse);
        let solve = |right: &[Scalar<'g>]| match by_inverse {
            true => inverse.iter().map(|row| dot(self.graph, row, right)).collect(),
            false => factorization.solve(right),
        };
        let n = self.model.coordinates.len();
        let solve_negative = |right: &Matrix<'g>| {
            let columns: Vec<Vec<_>> =
                (0..n).map(|j| solve(&right.iter().map(|row| -row[j]).collect::<Vec<_>>())).collect();
            (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect()
        };
        let accelerations = self.with_driven(&solve(&accelerating));
        let input = MotionInput { y, v, a: &accelerations };
        let mut forces = self.remaining_derivatives(input, || self.driving_forces_by_motion(y, v, u));
        for (row, more) in forces.by_coordinates.iter_mut().zip(wrenches.iter().flat_map(|(_, by)| by)) {
            *row = subtract(row, more);
        }
        AccelerationDerivatives {
            by_coordinates: solve_negative(&forces.by_coordinates),
            by_velocities: solve_negative(&forces.by_velocities),
            inverse,
            accelerations,
        }
    }

    /// Whether products with the inverse mass matrix need at most as many operations as solutions with the
    /// factors of the mass matrix. Products win at equal numbers, because their terms do not depend on each
    /// other.
    fn weighs_less_by_inverse(&self, factorization: &Factorization<'g>, inverse: &Matrix<'g>) -> bool {
        let right: Vec<_> = (0..inverse.len()).map(|k| self.graph.input(FREE, k)).collect();
        let weight = |results: Vec<Scalar<'g>>| {
            let all: Vec<Edge> =
                inverse.concat().iter().chain(&results).map(|result| result.edge()).collect();
            Cost::of(self.graph, &all).weight()
        };
        let product = inverse.iter().map(|row| dot(self.graph, row, &right)).collect();
        weight(product) <= weight(factorization.solve(&right))
    }

    /// Linearization `ÿ = A_y y + A_v ẏ + B_x u + c` at the state y, v and the input u. For robots with
    /// quaternions, the deviation δ from the given positions replaces y.
    pub fn linearize(&self, y: &[Scalar<'g>], v: &[Scalar<'g>], u: &[Scalar<'g>]) -> AffineAccelerations<'g> {
        let derivatives = self.forward_dynamics_derivatives(y, v, u);
        let input_matrix = self.loads_by_inputs(y, v, u);
        let zero = self.graph.constant(0.0);
        let by_inputs: Matrix<'g> = derivatives
            .inverse
            .iter()
            .map(|row| {
                (0..u.len())
                    .map(|j| row.iter().zip(&input_matrix).fold(zero, |sum, (&x, b)| sum + x * b[j]))
                    .collect()
            })
            .collect();
        // The deviation δ is 0 here, so it adds nothing to the remainder.
        let counted = if self.model.quaternion_joints.is_empty() { y } else { &[] };
        let remainder = (0..by_inputs.len()).map(|i| {
            let known = dot(self.graph, &derivatives.by_coordinates[i], counted)
                + dot(self.graph, &derivatives.by_velocities[i], v)
                + dot(self.graph, &by_inputs[i], u);
            derivatives.accelerations[i] - known
        });
        let remainder = remainder.collect();
        let AccelerationDerivatives { by_coordinates, by_velocities, .. } = derivatives;
        AffineAccelerations { by_coordinates, by_velocities, by_inputs, remainder }
    }

    /// Returns the driving forces if friction depends on the load or the input matrix B depends on the
    /// positions. Otherwise returns only the joint forces (springs, dampers and friction), because the
    /// remaining forces `B u` do not depend on y and ẏ.
    fn driving_forces_by_motion(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        match load_friction::is_there(self.model) || self.model.inputs_depend_on_position() {
            true => self.driving_forces(y, v, u),
            false => self.joint_forces(y, v),
        }
    }

    /// Derivatives of the driving forces with respect to the inputs: the input matrix B, with each row
    /// divided by the gain `1 + s₁ sign τ_l` of load-dependent friction. s₁ is the friction per unit of load,
    /// and τ_l the load (the drive's force without friction).
    fn loads_by_inputs(&self, y: &[Scalar<'g>], v: &[Scalar<'g>], u: &[Scalar<'g>]) -> Matrix<'g> {
        let matrix = self.input_matrix(y);
        let Some(shares) = self.load_shares(y, v) else {
            return matrix;
        };
        let exerted = subtract(&self.input_forces(y, u), &self.friction_torques(y, v));
        let gains = exerted.iter().zip(&shares).map(|(&exerted, &share)| load_friction::gain(exerted, share));
        let rows = matrix.into_iter().zip(gains);
        rows.map(|(row, gain)| row.into_iter().map(|entry| entry.divided_by(gain)).collect()).collect()
    }
}

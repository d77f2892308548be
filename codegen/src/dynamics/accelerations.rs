//! Accelerations of one robot over a graph, their derivatives, and the linearization.

use super::equations::Equations;
use super::load_friction;
use super::matrix::{FREE, Matrix, dot, subtract, sum};
use super::recursion::derivatives::ForceDerivatives;
use super::recursion::factorization::Factorization;
use super::recursion::motion::MotionInput;
use crate::graph::{Cost, Edge, Scalar};
use crate::spatial::Force;

/// Accelerations and their derivatives.
#[derive(Debug, Clone)]
pub struct AccelerationDerivatives<'g> {
    /// ÿ
    pub accelerations: Vec<Scalar<'g>>,
    /// ∂ÿ/∂y
    pub by_coordinates: Matrix<'g>,
    /// ∂ÿ/∂ẏ
    pub by_velocities: Matrix<'g>,
    /// M⁻¹
    pub inverse: Matrix<'g>,
}

/// `ÿ = A_y y + A_v ẏ + B_x u + c`
#[derive(Debug, Clone)]
pub struct AffineAccelerations<'g> {
    /// A_y
    pub by_coordinates: Matrix<'g>,
    /// A_v
    pub by_velocities: Matrix<'g>,
    /// B_x
    pub by_inputs: Matrix<'g>,
    /// c
    pub remainder: Vec<Scalar<'g>>,
}

/// Accelerations, M⁻¹ and derivatives of forces, from which the derivatives of accelerations are computed.
#[derive(Debug, Clone)]
pub struct AcceleratedForces<'g> {
    /// ÿ
    pub accelerations: Vec<Scalar<'g>>,
    /// M⁻¹
    pub inverse: Matrix<'g>,
    /// Forces M ÿ + k − q at these accelerations, with derivatives.
    pub forces: ForceDerivatives<'g>,
}

impl<'g> Equations<'_, 'g> {
    /// `M⁻¹ (q + B u − k)`
    pub fn forward_dynamics(&self, y: &[Scalar<'g>], v: &[Scalar<'g>], u: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let route = self.formulations.forward_dynamics();
        let input = MotionInput { y, v, a: &self.unaccelerated() };
        route.accelerations(self.graph, self.formulations, input, || self.driving_forces(y, v, u))
    }

    /// `M⁻¹ (q + B u + Σ Jᵀ w − k)`
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

    /// Accelerations under wrenches, with derivatives by y, by ẏ and by the joint forces (M⁻¹).
    pub fn forward_dynamics_derivatives_with_wrenches(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
        w: &[Force<'g>],
    ) -> AccelerationDerivatives<'g> {
        self.acceleration_derivatives(y, v, u, Some(w))
    }

    /// Accelerations with derivatives by y, by ẏ and by the joint forces (M⁻¹).
    pub fn forward_dynamics_derivatives(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> AccelerationDerivatives<'g> {
        self.acceleration_derivatives(y, v, u, None)
    }

    /// Accelerations, M⁻¹, and forces with derivatives by y and ẏ, of a robot without driven joints: `∂ÿ =
    /// −M⁻¹ ∂(M ÿ + k − q)`.
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

    /// Whether products with M⁻¹ cost no more than solutions by the factors. The products are preferred where
    /// both cost the same: their terms do not wait for each other.
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

    /// `ÿ = A_y y + A_v ẏ + B_x u + c` at a state and input.
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
        // Positions with a quaternion are given by the small motion from them, which is 0 here.
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

    /// The part of [`Self::driving_forces`] that depends on the motion.
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

    /// Derivatives of the driving forces by the inputs: B, its rows divided by the gains of loads.
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

//! Centre of mass c of the robot, and momentum about c in the axes of the base (Orin, Goswami and Lee 2013).
//!
//! Column j of the centroidal momentum matrix is the momentum of all bodies beyond joint j for a unit of this
//! joint's velocity. Let m, h = ∫ r dm and Σ = ∫ r rᵀ dm be the mass and the moments of these bodies about a
//! point o of the joint. Let (ω, v) be the unit motion at o. Then the linear momentum p and the angular
//! momentum L about c are
//!
//! ```text
//! p = m v + ω × h          L = (tr Σ − Σ) ω + h × v + (o − c) × p
//! ```

use super::formulation::Formulation;
use super::recursion::composite;
use super::recursion::frame_motion::BasePoses;
use super::recursion::placement::place;
use crate::dynamics::matrix::Matrix;
use crate::graph::Scalar;
use crate::kinematics::Mechanism;
use crate::spatial::{Force, Vector3};

/// Masses of a mechanism at given positions, from which its centre of mass and its momentum are computed.
pub struct Masses<'g> {
    mechanism: Mechanism<Scalar<'g>>,
    plain: Formulation,
    y: Vec<Scalar<'g>>,
}

impl<'g> Masses<'g> {
    /// Stores the mechanism and the positions `y`.
    ///
    /// - `mechanism`: lengths in metres, masses of the description
    pub fn new(mechanism: Mechanism<Scalar<'g>>, y: &[Scalar<'g>]) -> Self {
        let plain = Formulation::plain(mechanism.bodies.len());
        Self { mechanism, plain, y: y.to_vec() }
    }

    /// Total mass of the moving bodies (kg).
    fn total(&self) -> Scalar<'g> {
        let zero = self.mechanism.graph.constant(0.0);
        self.mechanism.bodies.iter().fold(zero, |sum, body| sum + body.moments.mass)
    }

    /// Centre of mass of the moving bodies in the base frame \[m\].
    pub fn center(&self) -> Vector3<Scalar<'g>> {
        let first = composite::first_moment(&self.mechanism, &self.plain, &self.y);
        let total = self.total();
        first.map(|x| x.divided_by(total)).named("center_of_mass")
    }

    /// Momentum about the robot's centre of mass for a unit of each velocity. The six rows are linear, then
    /// angular momentum.
    fn columns(&self) -> Vec<Vec<Scalar<'g>>> {
        let mechanism = &self.mechanism;
        let placements = place(mechanism, &self.plain, &self.y);
        let composites = composite::composites(mechanism, &self.plain, &placements);
        let poses = BasePoses::new(mechanism.clone(), &self.y);
        let (center, zero) = (self.center(), mechanism.graph.constant(0.0));
        let mut rows = vec![vec![zero; mechanism.coordinates]; 6];
        for (index, body) in mechanism.bodies.iter().enumerate() {
            let unit = body.axis.unit_motion(zero);
            let Force { force, moment } = composites[index].moments.times(unit);
            let pose = poses.body(index);
            let (force, moment) = (pose.direction(force), pose.direction(moment));
            let moment = moment + (pose.origin - center).cross(force);
            for (row, entry) in rows.iter_mut().zip(force.0.into_iter().chain(moment.0)) {
                body.transmission.add_force(entry, row);
            }
        }
        for rotor in &mechanism.rotors {
            let Some(carrier) = rotor.carrier else { continue };
            let spin = poses.body(carrier).direction(rotor.axis.scaled(rotor.coupling_inertia()));
            for (row, entry) in rows[3..].iter_mut().zip(spin.0) {
                rotor.transmission.add_force(entry, row);
            }
        }
        rows
    }

    /// Centroidal momentum matrix, 6 × n. Its product with the velocities is the momentum in the axes of the
    /// base: the linear momentum in the first three rows, and the angular momentum about the centre of mass
    /// in the last three rows.
    pub fn momentum_matrix(&self) -> Matrix<'g> {
        self.columns()
    }

    /// Jacobian ∂c/∂y of the centre of mass c, 3 × n for n velocities. For joints with quaternions, the
    /// derivatives are along small motions.
    pub fn center_jacobian(&self) -> Matrix<'g> {
        let total = self.total();
        let rows = self.columns().into_iter().take(3);
        rows.map(|row| row.into_iter().map(|x| x.divided_by(total)).collect()).collect()
    }
}

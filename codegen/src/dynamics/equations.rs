//! Equations of motion of a robot as expressions of the graph. Each quantity is derived by the formulation
//! with the fewest operations. A formulation is one way to write the same equations.

use super::forces;
use super::formulation::Formulation;
use super::frame_forces::FrameForces;
use super::load_friction;
use super::matrix::{Matrix, dot, subtract, sum};
use super::momentum::Masses;
use super::parameters::regressor;
use super::recursion::composite;
use super::recursion::derivatives::ForceDerivatives;
use super::recursion::frame_motion::BasePoses;
use super::recursion::motion::MotionInput;
use super::recursion::newton_euler;
use super::search::routes::Formulations;
use super::tangent::{differentiate_along, drift, gradient_along};
use crate::graph::{Graph, Scalar, differentiate};
use crate::kinematics::{Mechanism, RegroupChoice};
use crate::model::Model;
use crate::spatial::{Force, Vector3, rotate};
use gelenk_formula::Function;

/// The equations of motion `M(y) ÿ + k(y, ẏ) = q(y, ẏ) + B u` of a model on one graph. The symbols are
/// defined in [`crate::guide::conventions`].
#[derive(Debug, Clone, Copy)]
pub struct Equations<'a, 'g> {
    /// Graph that contains all expressions.
    pub graph: &'g Graph,
    /// Model of the robot whose equations are derived.
    pub model: &'a Model,
    /// Formulation with the fewest operations of each quantity, for example of the mass matrix.
    pub formulations: &'a Formulations<'a>,
    /// Prescribed accelerations of the driven coordinates. These coordinates are the last entries of all
    /// vectors by coordinate. Force vectors also have entries for them, as if they were free.
    pub driven: &'a [Scalar<'g>],
}

impl<'g> Equations<'_, 'g> {
    /// The bodies, joints and rotors as expressions of the graph, in metres and with the masses of the
    /// description.
    pub(super) fn mechanism(&self) -> Mechanism<Scalar<'g>> {
        self.formulations.mechanism().on(self.graph)
    }

    fn zeros(&self) -> Vec<Scalar<'g>> {
        vec![self.graph.constant(0.0); self.model.motion_count()]
    }

    /// Acceleration vector in which free coordinates have 0 and driven coordinates their prescribed
    /// acceleration.
    pub fn unaccelerated(&self) -> Vec<Scalar<'g>> {
        self.with_driven(&self.zeros())
    }

    /// Accelerations of all coordinates: `accelerations` of the free ones, then the prescribed accelerations
    /// of the others.
    pub(super) fn with_driven(&self, accelerations: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let own = &accelerations[..self.model.coordinates.len()];
        [own, self.driven].concat()
    }

    fn recursive(
        &self,
        formulation: &Formulation,
        input: MotionInput<'_, 'g>,
        with_gravity: bool,
    ) -> Vec<Scalar<'g>> {
        let mut mechanism = formulation.mechanism(self.graph, self.formulations.mechanism());
        if !with_gravity {
            mechanism.gravity = Vector3::zero(self.graph.constant(0.0));
        }
        newton_euler::inverse_dynamics(&mechanism, formulation, input)
    }

    /// Mass matrix `M(y)` at the coordinates y.
    pub fn mass_matrix(&self, y: &[Scalar<'g>]) -> Matrix<'g> {
        self.mass_matrix_by(self.formulations.mass_matrix(), y)
    }

    pub(super) fn mass_matrix_by(&self, formulation: &Formulation, y: &[Scalar<'g>]) -> Matrix<'g> {
        composite::mass_matrix(
            &formulation.mechanism(self.graph, self.formulations.mechanism()),
            formulation,
            y,
        )
    }

    /// Mass matrix `M(y)` and bias forces `k − q_gravity` (Coriolis forces k minus the generalized forces of
    /// gravity). The two are derived by the pair of formulations with the fewest operations in total.
    pub fn mass_matrix_and_bias(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> (Matrix<'g>, Vec<Scalar<'g>>) {
        self.formulations.mass_matrix_and_bias(self.graph, MotionInput { y, v, a: &self.unaccelerated() })
    }

    pub(super) fn bias_by(
        &self,
        formulation: &Formulation,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        self.recursive(formulation, MotionInput { y, v, a: &self.unaccelerated() }, true)
    }

    /// Coriolis, centrifugal and gyroscopic forces `k(y, ẏ)`.
    pub fn coriolis_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let input = MotionInput { y, v, a: &self.unaccelerated() };
        self.recursive(self.formulations.bias_forces(), input, false)
    }

    /// Generalized forces of gravity, a part of the applied forces q.
    pub fn gravity_forces(&self, y: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let still = self.zeros();
        let held =
            self.recursive(self.formulations.gravity_forces(), MotionInput { y, v: &still, a: &still }, true);
        held.into_iter().map(|x| -x).collect()
    }

    /// Bias forces `k − q_gravity`: the Coriolis forces k minus the generalized forces of gravity.
    pub fn bias_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        self.bias_by(self.formulations.bias_forces(), y, v)
    }

    /// Generalized forces of springs and dampers at joints and between frames, a part of the applied forces
    /// q.
    pub fn spring_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let at_joints = forces::spring_forces(self.graph, self.model, y, v);
        if self.model.point_forces.is_empty() {
            return at_joints;
        }
        sum(&at_joints, &self.frame_forces(y).law_forces(v))
    }

    fn frame_forces<'y>(&'y self, y: &'y [Scalar<'g>]) -> FrameForces<'y, 'g> {
        FrameForces::new(self.model, self.mechanism(), y)
    }

    /// Input matrix B(y) as a list of rows. The columns of drives come first, then the columns of inputs at
    /// frames.
    ///
    /// - `y`: may be empty if B is constant
    pub fn input_matrix(&self, y: &[Scalar<'g>]) -> Matrix<'g> {
        let mut matrix = forces::drive_matrix(self.graph, self.model);
        if self.model.inputs_depend_on_position() {
            for column in self.frame_forces(y).input_columns() {
                for (row, entry) in matrix.iter_mut().zip(column) {
                    row.push(entry);
                }
            }
        }
        matrix
    }

    /// Generalized forces `Σ Jᵀ w` of wrenches w at frames with the Jacobians J.
    pub fn wrench_forces(&self, y: &[Scalar<'g>], w: &[Force<'g>]) -> Vec<Scalar<'g>> {
        self.frame_forces(y).wrench_forces(w)
    }

    /// Friction torques τ(y, ẏ), without load-dependent friction. `y` may be empty if no friction law depends
    /// on the position.
    pub fn friction_torques(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        forces::friction_torques(self.graph, self.model, y, v)
    }

    /// Generalized forces of springs, dampers and friction: `spring_forces − friction_torques`, a part of the
    /// applied forces q.
    pub fn joint_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        subtract(&self.spring_forces(y, v), &self.friction_torques(y, v))
    }

    /// Applied forces `q = q_gravity + q_springs − τ`: forces of gravity and of springs, minus the friction
    /// torques τ.
    pub fn applied_forces(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let joint = self.joint_forces(y, v);
        sum(&self.gravity_forces(y), &joint)
    }

    /// Coefficients s₁ as in [`load_friction`](Self::load_friction). `None` if no joint has load-dependent
    /// friction.
    pub(super) fn load_shares(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Option<Vec<Scalar<'g>>> {
        load_friction::is_there(self.model).then(|| load_friction::shares(self.graph, self.model, y, v))
    }

    /// Coefficient s₁(y, ẏ) of load-dependent friction of each coordinate (no unit). The friction force is s₁
    /// times the magnitude of the load. The load is the drive's force minus all friction.
    pub fn load_friction(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        load_friction::shares(self.graph, self.model, y, v)
    }

    /// Inverse dynamics `B u = M ÿ + k − q` with Coriolis forces k and applied forces q, including
    /// load-dependent friction.
    pub fn inverse_dynamics(&self, y: &[Scalar<'g>], v: &[Scalar<'g>], a: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let bodies = self.recursive(self.formulations.inverse_dynamics(), MotionInput { y, v, a }, true);
        let Some(shares) = self.load_shares(y, v) else {
            return subtract(&bodies, &self.joint_forces(y, v));
        };
        let loads = subtract(&bodies, &self.spring_forces(y, v));
        let friction = self.friction_torques(y, v);
        let exerted = loads.iter().zip(&friction).map(|(&load, &friction)| load + friction);
        let more = loads.iter().zip(&shares).map(|(&load, &share)| load_friction::friction(load, share));
        exerted.zip(more).map(|(exerted, more)| exerted + more).collect()
    }

    /// Inverse dynamics `M ÿ + k − q` including load-dependent friction, with derivatives with respect to y
    /// and ẏ, and with the mass matrix M. k are Coriolis forces, q applied forces.
    pub fn inverse_dynamics_derivatives(&self, input: MotionInput<'_, 'g>) -> ForceDerivatives<'g> {
        let Some(shares) = self.load_shares(input.y, input.v) else {
            return self.remaining_derivatives(input, || self.joint_forces(input.y, input.v));
        };
        let mut result = self.remaining_derivatives(input, || self.spring_forces(input.y, input.v));
        let friction = self.friction_torques(input.y, input.v);
        for (row, (&share, &friction)) in shares.iter().zip(&friction).enumerate() {
            let load = result.forces[row];
            let (gain, magnitude) = (load_friction::gain(load, share), load.call(Function::Abs));
            // If the load is given, the friction of a joint depends only on the motion of this joint.
            let whole = |by: Vec<Scalar<'g>>| by[0] + magnitude * by[1];
            let y = whole(self.along(&[friction, share], input.y, row));
            let v = whole(differentiate(self.graph, &[friction, share], input.v[row]));
            for (matrix, own) in [(&mut result.by_coordinates, y), (&mut result.by_velocities, v)] {
                matrix[row] = matrix[row].iter().map(|&by_load| gain * by_load).collect();
                matrix[row][row] = matrix[row][row] + own;
            }
            result.forces[row] = load + friction + magnitude * share;
        }
        result
    }

    /// Inertial and Coriolis forces minus gravity, `M ÿ + k − q_gravity`, minus `joint_forces`. Also returns
    /// the derivatives with respect to y and ẏ, and the mass matrix M.
    pub(super) fn remaining_derivatives(
        &self,
        input: MotionInput<'_, 'g>,
        joint_forces: impl FnOnce() -> Vec<Scalar<'g>>,
    ) -> ForceDerivatives<'g> {
        let (derivatives, inverse_dynamics) =
            (self.formulations.derivatives(), self.formulations.inverse_dynamics());
        let mut result =
            derivatives.derive(self.graph, self.formulations.mechanism(), inverse_dynamics, input);
        let joint = joint_forces();
        for (row, &force) in joint.iter().enumerate() {
            // Forces at single joints have diagonal derivatives.
            let columns = if self.forces_are_local() { row..row + 1 } else { 0..joint.len() };
            for column in columns {
                let by_position = self.along(&[force], input.y, column)[0];
                let y = &mut result.by_coordinates[row][column];
                *y = *y - by_position;
                let v = &mut result.by_velocities[row][column];
                *v = *v - differentiate(self.graph, &[force], input.v[column])[0];
            }
        }
        result.forces = subtract(&result.forces, &joint);
        result
    }

    /// Generalized forces `Σ Jᵀ w` of wrenches w at frames with the Jacobians J, with derivatives with
    /// respect to y.
    pub fn wrench_forces_derivatives(
        &self,
        y: &[Scalar<'g>],
        w: &[Force<'g>],
    ) -> (Vec<Scalar<'g>>, Matrix<'g>) {
        self.with_derivatives(self.wrench_forces(y, w), y)
    }

    /// Generalized forces `B u` of the inputs u, with derivatives with respect to the coordinates y.
    pub fn input_forces_derivatives(
        &self,
        y: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> (Vec<Scalar<'g>>, Matrix<'g>) {
        self.with_derivatives(self.input_forces(y, u), y)
    }

    /// Returns the forces together with their derivatives with respect to y.
    fn with_derivatives(&self, forces: Vec<Scalar<'g>>, y: &[Scalar<'g>]) -> (Vec<Scalar<'g>>, Matrix<'g>) {
        let columns: Vec<Vec<_>> =
            (0..y.len()).map(|coordinate| self.along(&forces, y, coordinate)).collect();
        let rows = (0..forces.len()).map(|row| columns.iter().map(|column| column[row]).collect());
        let rows = rows.collect();
        (forces, rows)
    }

    /// Derivatives of `results` along a coordinate. For joints with quaternions, they are derivatives along
    /// small rotations and translations of the body.
    pub fn along(&self, results: &[Scalar<'g>], y: &[Scalar<'g>], coordinate: usize) -> Vec<Scalar<'g>> {
        differentiate_along(self.graph, self.model, results, y, coordinate)
    }

    /// Derivatives of one result along all coordinates, as in [`Self::along`], and with respect to all
    /// velocities. Uses reverse differentiation.
    pub fn gradient_along(
        &self,
        result: Scalar<'g>,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
    ) -> (Vec<Scalar<'g>>, Vec<Scalar<'g>>) {
        gradient_along(self.graph, self.model, result, y, v)
    }

    /// Symmetrizes row and column `j` of the Hessian of `δ ↦ f(y ⊕ δ)` at δ = 0. Small motions of a joint
    /// with a quaternion do not commute. Each entry is therefore the mean of the two orders of
    /// differentiation.
    pub fn symmetrize_along(
        &self,
        hessian: &mut Matrix<'g>,
        gradient: &[Scalar<'g>],
        y: &[Scalar<'g>],
        j: usize,
    ) {
        let Some(joint) = self.model.quaternion_joint_of(j) else { return };
        for i in (j + 1..).take_while(|i| joint.coordinates().contains(i)) {
            let other = self.along(&gradient[j..=j], y, i)[0];
            let mean = (hessian[i][j] + other) * 0.5;
            hessian[i][j] = mean;
            hessian[j][i] = mean;
        }
    }

    /// Inverse dynamics `B u = M ÿ + k − q − Σ Jᵀ w` under wrenches w at frames with the Jacobians J. k are
    /// Coriolis forces, q applied forces.
    pub fn inverse_dynamics_with_wrenches(
        &self,
        MotionInput { y, v, a }: MotionInput<'_, 'g>,
        w: &[Force<'g>],
    ) -> Vec<Scalar<'g>> {
        subtract(&self.inverse_dynamics(y, v, a), &self.wrench_forces(y, w))
    }

    /// Inverse dynamics `M ÿ + k − q − Σ Jᵀ w` under wrenches w at frames with the Jacobians J. Also returns
    /// the derivatives with respect to y and ẏ, and the mass matrix M.
    pub fn inverse_dynamics_derivatives_with_wrenches(
        &self,
        input: MotionInput<'_, 'g>,
        w: &[Force<'g>],
    ) -> ForceDerivatives<'g> {
        let mut result = self.inverse_dynamics_derivatives(input);
        let (forces, by_coordinates) = self.wrench_forces_derivatives(input.y, w);
        result.forces = subtract(&result.forces, &forces);
        for (row, more) in result.by_coordinates.iter_mut().zip(&by_coordinates) {
            *row = subtract(row, more);
        }
        result
    }

    /// Whether the forces of springs and friction on each coordinate depend only on the motion of this
    /// coordinate.
    pub(super) fn forces_are_local(&self) -> bool {
        let model = self.model;
        model.followers.is_empty()
            && model.rubbing_drives().next().is_none()
            && model.point_forces.is_empty()
            && model.force_inputs.is_empty()
    }

    /// Matrix D in `δ̇ = D δ + v − v̄`. δ is the deviation from a motion with the velocities v̄, which are
    /// the argument `v`. D is zero in the rows of joints without quaternions.
    pub fn drift(&self, v: &[Scalar<'g>]) -> Matrix<'g> {
        drift(self.graph, self.model, v)
    }

    /// Generalized forces `B u` of the inputs u with the input matrix B.
    pub fn input_forces(&self, y: &[Scalar<'g>], u: &[Scalar<'g>]) -> Vec<Scalar<'g>> {
        let matrix = self.input_matrix(y);
        let zero = self.graph.constant(0.0);
        matrix.iter().map(|row| row.iter().zip(u).fold(zero, |sum, (&b, &u)| sum + b * u)).collect()
    }

    /// Driving forces: spring forces, plus the drive forces `B u` minus friction. Gravity is not included.
    pub(super) fn driving_forces(
        &self,
        y: &[Scalar<'g>],
        v: &[Scalar<'g>],
        u: &[Scalar<'g>],
    ) -> Vec<Scalar<'g>> {
        let Some(shares) = self.load_shares(y, v) else {
            return sum(&self.input_forces(y, u), &self.joint_forces(y, v));
        };
        let exerted = subtract(&self.input_forces(y, u), &self.friction_torques(y, v));
        let loads = exerted.iter().zip(&shares).map(|(&exerted, &share)| load_friction::load(exerted, share));
        loads.zip(self.spring_forces(y, v)).map(|(load, spring)| load + spring).collect()
    }

    /// Wrench that each moving joint transmits to the link that it carries. Each joint has one row: the
    /// force, then the moment about the link's origin, in the axes of the link.
    pub fn joint_wrenches(&self, input: MotionInput<'_, 'g>) -> Matrix<'g> {
        let mechanism = self.mechanism();
        let plain = Formulation::plain(mechanism.bodies.len());
        let wrenches = newton_euler::wrenches(&mechanism, &plain, input);
        let wrench = |link: usize| {
            let (body, pose) = mechanism.links[link];
            let body = body.unwrap_or_else(|| unreachable!("a moving joint carries its link"));
            let Force { moment, force } = wrenches[body];
            let moment = moment - pose.translation.cross(force);
            let axes = pose.rotation.transpose();
            [rotate(&axes, force).0, rotate(&axes, moment).0].concat()
        };
        self.model.carrying_joints().into_iter().map(|joint| wrench(joint.moving.link)).collect()
    }

    /// Regressor W of the inertial parameters π: `W π = M ÿ + k − q_gravity`, the required forces without
    /// springs and friction.
    pub fn inertial_regressor(&self, input: MotionInput<'_, 'g>) -> Matrix<'g> {
        regressor::inertial_regressor(&self.mechanism(), self.model, input)
    }

    /// Regressor of the base parameters (identifiable combinations of inertial parameters). It has the
    /// columns of [`Self::inertial_regressor`] for one leading parameter of each combination.
    pub fn base_regressor(&self, input: MotionInput<'_, 'g>) -> Matrix<'g> {
        let leaders = &self.formulations.base_parameters().leaders;
        let rows = self.inertial_regressor(input).into_iter();
        rows.map(|row| leaders.iter().map(|&column| row[column]).collect()).collect()
    }

    /// Kinetic energy `½ ẏᵀ M ẏ` \[J\] with the mass matrix M. M ẏ is computed by the inverse dynamics at
    /// zero velocity with the accelerations ẏ and without gravity.
    pub fn kinetic_energy(&self, y: &[Scalar<'g>], v: &[Scalar<'g>]) -> Scalar<'g> {
        let formulation = self.formulations.inverse_dynamics();
        let momentum = self.recursive(formulation, MotionInput { y, v: &self.zeros(), a: v }, false);
        dot(self.graph, &momentum, v) * 0.5
    }

    /// Potential energy \[J\]: `−g · Σ m c` over the moving bodies, plus the energies of forces between
    /// frames. g is the gravitational acceleration, m the mass of a body and c its centre of mass in the base
    /// frame.
    pub fn potential_energy(&self, y: &[Scalar<'g>]) -> Scalar<'g> {
        let plain = Formulation::plain(self.formulations.mechanism().bodies.len());
        let choices = vec![RegroupChoice::Massless; plain.bodies.len()];
        let mechanism = self.mechanism().regrouped(&choices);
        let of_gravity = -mechanism.gravity.dot(composite::first_moment(&mechanism, &plain, y));
        if self.model.point_forces.is_empty() {
            return of_gravity;
        }
        self.frame_forces(y).law_energies().into_iter().fold(of_gravity, |sum, energy| sum + energy)
    }

    /// Masses of the bodies at the positions `y`, from which centre of mass and momentum are computed.
    pub fn masses(&self, y: &[Scalar<'g>]) -> Masses<'g> {
        Masses::new(self.mechanism(), y)
    }

    /// Product of a matrix row and the velocities `v`.
    pub fn along_velocities(&self, row: &[Scalar<'g>], v: &[Scalar<'g>]) -> Scalar<'g> {
        dot(self.graph, row, v)
    }

    /// Poses of the bodies in the base frame at the positions `y`.
    pub fn base_poses(&self, y: &[Scalar<'g>]) -> BasePoses<'g> {
        BasePoses::new(self.mechanism(), y)
    }
}

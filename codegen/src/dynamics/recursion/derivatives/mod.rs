//! Analytic derivatives of the inverse dynamics by composite bodies.
//!
//! A disturbance of a body consists of an angular velocity δω, of β = δω̇ + ω × δω, and of an acceleration δa
//! of the body's origin. A point of this body, or of a body beyond it, has the position r and the velocity ṙ
//! relative to this origin. The additional acceleration of the point is
//!
//! ```text
//! δr̈ = δa + β × r + 2 δω × ṙ
//! ```
//!
//! δω and β are the same for all these bodies. The resulting force and moment depend only on the composite
//! moments m, h = ∫ r dm, Σ = ∫ r rᵀ dm, 2 P = 2 ∫ ṙ dm and 2 K = 2 ∫ ṙ rᵀ dm:
//!
//! ```text
//! δF = m δa + β × h + δω × 2P
//! δn = h × δa + (tr Σ − Σ) β + (tr 2K − 2K) δω
//! ```
//!
//! All vectors have components in the frame that moves with the body, and a is the acceleration of the body's
//! origin minus gravity. With U = ω̇× + ω× ω× and the joint's axis z, a unit of the joint's position or
//! velocity causes these disturbances:
//!
//! - position of a revolute joint: `δω = ω × z`, `β = U z`, `δa = a × z`
//! - velocity of a revolute joint: `δω = z`, `β = 2 ω × z`
//! - position of a prismatic joint: `δa = U z`
//! - velocity of a prismatic joint: `δa = 2 ω × z`
//!
//! These are the derivatives of Carpentier and Mansard (2018) and of Singh, Russell and Wensing (2022). They
//! use classical accelerations instead of spatial accelerations, so they require no linear velocities.

mod base_body;
mod column;
mod flow;
#[cfg(test)]
mod tests;
mod tree;

use self::column::{Column, Disturbed};
use self::flow::levers;
use self::tree::Tree;
use super::composite::mirror;
use super::motion::MotionInput;
use super::newton_euler::inverse_dynamics_parts;
use super::quaternion::{force_along, unit_motion};
use super::rotor;
use crate::dynamics::formulation::Formulation;
use crate::dynamics::matrix::Matrix;
use crate::graph::Scalar;
use crate::kinematics::{Body, ChainPlace, Followed, Mechanism};
use crate::spatial::Force;

/// Forces of the inverse dynamics, their derivatives with respect to positions and velocities, and the mass
/// matrix.
#[derive(Debug, Clone)]
pub struct ForceDerivatives<'g> {
    /// Forces by coordinate. [`inverse_dynamics_derivatives`] returns `M ÿ + k − q_gravity`, that is inertial
    /// and Coriolis forces minus gravity.
    pub forces: Vec<Scalar<'g>>,
    /// Derivatives of the forces with respect to the coordinates y. Row i belongs to force i.
    pub by_coordinates: Matrix<'g>,
    /// Derivatives of the forces with respect to the velocities ẏ. Row i belongs to force i.
    pub by_velocities: Matrix<'g>,
    /// Mass matrix M by coordinate.
    pub mass_matrix: Matrix<'g>,
}

/// Frame in which the derivatives for pairs of joints are computed. A column contains the derivatives of the
/// forces of all joints on the path to the base with respect to the motion of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairFrame {
    /// The frame of each body's equations on the path to the base. A column of derivatives is transformed
    /// from body to body.
    Links,
    /// The frame of the tree's first body. Columns of derivatives need no transformation from body to body,
    /// but each product has all components. All bodies must have the same unit of length.
    Root,
}

/// Computes `M ÿ + k − q_gravity` (inertial and Coriolis forces minus gravity), its derivatives with respect
/// to y and ẏ, and the mass matrix M. `formulation` chooses how the equations are written.
pub fn inverse_dynamics_derivatives<'g>(
    mechanism: &Mechanism<Scalar<'g>>,
    formulation: &Formulation,
    pairs: PairFrame,
    input: MotionInput<'_, 'g>,
) -> ForceDerivatives<'g> {
    // The whole wrench of each body is needed, so moments must be passed from body to parent.
    let formulation = &formulation.without_shortcuts();
    let parts = inverse_dynamics_parts(mechanism, formulation, input);
    let zeros = vec![vec![mechanism.graph.constant(0.0); mechanism.coordinates]; mechanism.coordinates];
    let mut result = ForceDerivatives {
        forces: parts.generalized,
        by_coordinates: zeros.clone(),
        by_velocities: zeros.clone(),
        mass_matrix: zeros,
    };
    let tree = Tree {
        mechanism,
        placements: &parts.placements,
        motions: &parts.motions,
        levers: levers(mechanism, &parts.placements, &parts.motions, input),
        base: Vec::new(),
    };
    let tree = match pairs {
        PairFrame::Links => tree,
        PairFrame::Root => Tree { base: tree.base_bodies(), ..tree },
    };
    let flows = tree.flows(formulation, input);
    for index in 0..mechanism.bodies.len() {
        let moving = mechanism.bodies[index].chain.map_or(index, |place| place.last);
        let column = tree.column(index, &flows[moving], &parts.wrenches[index]);
        let coordinates = tree.coordinates_of(index);
        tree.read_own(index, &coordinates, &column, &mut result);
        let source = Source { joint: Some(index), coordinates };
        match mechanism.bodies[index].chain {
            None => tree.walk(index, &source, tree.depart(index, column), &mut result),
            Some(place) => {
                tree.leave_chain(index, place, &source, column, parts.wrenches[place.last], &mut result)
            }
        }
    }
    rotor::add_inertia(&mechanism.rotors, &mut result.mass_matrix);
    for rotor in &mechanism.rotors {
        let passed = |carrier| rotor.driven.is_some_and(|driven| tree.passes(driven, carrier));
        let Some(carrier) = rotor.carrier.filter(|&carrier| !passed(carrier)) else {
            continue;
        };
        let mut column = Column::zero(mechanism);
        tree.add_rotor_coupling(carrier, rotor, &mut column);
        let source = Source { joint: None, coordinates: rotor.transmission.terms.clone() };
        tree.arrive(carrier, &source, column, &mut result);
    }
    mirror(mechanism, &mut result.mass_matrix);
    result
}

/// The joint or rotor to whose motion a column of derivatives belongs.
struct Source<'g> {
    /// The body that the column's joint moves; `None` if the column belongs to a rotor.
    joint: Option<usize>,
    /// Coordinates to which the column of derivatives belongs, each with its factor.
    coordinates: Vec<Followed<Scalar<'g>>>,
}

impl<'g> Tree<'_, 'g> {
    /// Transforms a column of derivatives from a body to the base, and adds its entries for each joint on the
    /// path.
    fn walk(
        &self,
        start: usize,
        source: &Source<'g>,
        mut column: Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        let mut index = start;
        while let Some(parent) = self.mechanism.bodies[index].parent {
            if self.base.is_empty() {
                column = self.pass_on(index, &column);
            }
            index = parent;
            if let Some(joint) = source.joint {
                self.add_rotor_couplings(index, joint, &mut column);
            }
            (index, column) = self.read_joint(index, source, column, result);
        }
    }

    /// Adds the entries of a column of derivatives for the joint of a body and for all joints before it.
    fn arrive(
        &self,
        index: usize,
        source: &Source<'g>,
        column: Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        let (index, column) = self.read_joint(index, source, column, result);
        self.walk(index, source, column, result);
    }

    /// Adds the entry of a column of derivatives for the joint of a body. Returns the body at which the
    /// column continues.
    fn read_joint(
        &self,
        index: usize,
        source: &Source<'g>,
        column: Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) -> (usize, Column<'g>) {
        match self.mechanism.bodies[index].chain {
            None => {
                self.read_off(index, source, &column, result);
                (index, column)
            }
            Some(place) => {
                self.read_chain(place, place.last + 1, source, &column, result);
                (place.first, self.pass_chain(place, column))
            }
        }
    }

    /// Adds the entries for the velocities that precede body `end` among the bodies of a joint with a
    /// quaternion. The column is in the frame of the body that the joint moves.
    fn read_chain(
        &self,
        place: ChainPlace,
        end: usize,
        source: &Source<'g>,
        column: &Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        for velocity in place.first..end {
            self.read_off(velocity, source, column, result);
        }
    }

    /// Transforms a column of derivatives from the frame of the last body of a joint with a quaternion to the
    /// frame of its first body. Only the axes change.
    fn pass_chain(&self, place: ChainPlace, mut column: Column<'g>) -> Column<'g> {
        for index in (place.first + 1..=place.last).rev() {
            column = self.pass_on(index, &column);
        }
        column
    }

    /// Continues the derivatives for one velocity of a joint with a quaternion towards the base. They are in
    /// the frame of the moved body. For the joints before it, the rotation of this frame is added to the
    /// derivative with respect to the coordinate.
    fn leave_chain(
        &self,
        index: usize,
        place: ChainPlace,
        source: &Source<'g>,
        mut column: Column<'g>,
        needed: Force<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        self.read_chain(place, index, source, &column, result);
        let turns = self.mechanism.bodies[index].axis.turns();
        let screw = unit_motion(turns, place, needed.force[0]);
        column.stiffness = column.stiffness + screw.cross_force(needed);
        let column = self.pass_chain(place, column);
        self.walk(place.first, source, column, result);
    }

    /// Adds the diagonal entries of the derivatives: the entries of a column for the column's own joint.
    fn read_own(
        &self,
        index: usize,
        coordinates: &[Followed<Scalar<'g>>],
        values: &Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        let transmission = &self.mechanism.bodies[index].transmission;
        for &Followed { coordinate, ratio } in coordinates {
            let along = |f| self.own_force(index, f) * ratio;
            let add = |f, matrix| transmission.add_row_entry(coordinate, along(f), matrix);
            add(values.inertial, &mut result.mass_matrix);
            add(values.damping, &mut result.by_velocities);
            add(values.stiffness, &mut result.by_coordinates);
        }
    }

    /// Component of a transformed force along the joint of a body, in the frame in which pairs of joints are
    /// computed.
    fn met_by(&self, index: usize, f: Force<'g>) -> Scalar<'g> {
        match self.base.get(index) {
            None => self.own_force(index, f),
            Some(body) => body.screw.dot(f),
        }
    }

    /// Component of a force along the joint of a body, in the frame of the body's equations.
    fn own_force(&self, index: usize, f: Force<'g>) -> Scalar<'g> {
        let Body { axis, chain, .. } = &self.mechanism.bodies[index];
        match chain {
            None => axis.force(f),
            Some(place) => force_along(axis.turns(), *place, f),
        }
    }

    /// Adds the derivatives that couple the column's coordinates with the joint of a body.
    fn read_off(
        &self,
        index: usize,
        source: &Source<'g>,
        values: &Column<'g>,
        result: &mut ForceDerivatives<'g>,
    ) {
        let row = &self.mechanism.bodies[index].transmission;
        for &Followed { coordinate, ratio } in &source.coordinates {
            let met = |f| self.met_by(index, f) * ratio;
            row.add_coupling(coordinate, met(values.inertial), &mut result.mass_matrix);
            row.add_row_entry(coordinate, met(values.damping), &mut result.by_velocities);
            row.add_row_entry(coordinate, met(values.stiffness), &mut result.by_coordinates);
        }
        let disturbance =
            self.base.get(index).map_or_else(|| self.disturbance(index), |body| body.disturbance);
        let gain = |disturbed: Disturbed<'g>| {
            let Force { force, moment } = values.inertial;
            let by_motion = moment.dot(disturbed.beta) + force.dot(disturbed.acceleration);
            values.by_omega.dot(disturbed.omega) + by_motion
        };
        for &Followed { coordinate, ratio } in &source.coordinates {
            let gained = |disturbed| gain(disturbed) * ratio;
            row.add_column_entry(coordinate, gained(disturbance.by_coordinate), &mut result.by_coordinates);
            row.add_column_entry(coordinate, gained(disturbance.by_velocity), &mut result.by_velocities);
        }
    }
}

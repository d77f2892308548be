//! Alternative formulations of the same equations.

use crate::graph::{Graph, Scalar};
use crate::kinematics::{Mechanism, Number, RegroupChoice};

/// Derivation of the acceleration of a body's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngularRoute {
    /// Computes U = ω̇× + ω× ω× from the angular acceleration ω̇.
    Acceleration,
    /// Computes U from points of the joint's axis. These points belong to parent and child, so U z transforms like a
    /// vector. Only ω, U z and the axial acceleration are passed on.
    AxisPoints,
}

/// Derivation of U's diagonal and of its differences, which multiply second moments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagonal {
    /// Diagonal from squares of ω, differences from the diagonal.
    Sums,
    /// Diagonal and differences from squares of ω.
    Squares,
    /// Diagonal as a sum over axis points. U_zz is known, so the square of ω_x is not needed.
    Axis,
    /// Like `Axis`, without the square of ω_y.
    AxisAcross,
}

/// Assignment of the translation along a joint's axis to a body's origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lift {
    /// The body has the translation. Its origin is the point of its axis nearest to the axis of its main child.
    Own,
    /// The children have the translation. The origin of the body is at the end of the translation from the parent.
    OfChildren,
    /// The translation from the parent includes it.
    OfParent,
}

/// Frame of a body's equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkingFrame {
    /// The body's own frame.
    Body,
    /// The joint's frame before its motion; the inertia is rotated instead of the velocities.
    BeforeJoint,
}

/// Source and sink of a body's quantities in a run of parallel joints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunLink {
    /// The parent.
    Parent,
    /// The base of the run; joint angles are added before the sine.
    RunBase,
}

/// Free rotation of a leaf's frame about its own axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafAlignment {
    /// No offset of the angle.
    NoOffset,
    /// The first moment has no y component.
    FirstMoment,
    /// The second moment has no xy component.
    SecondMoment,
}

/// Choices for one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyChoices {
    /// Derivation of U.
    pub angular: AngularRoute,
    /// Derivation of U's diagonal.
    pub diagonal: Diagonal,
    /// Whether U_zx is computed from the y component of the angular acceleration, which children may need.
    /// Only for axis points.
    pub by_acceleration: bool,
    /// Assignment of the translation along the axis.
    pub lift: Lift,
    /// Frame of the equations.
    pub frame: WorkingFrame,
    /// Source of angular velocity and acceleration.
    pub source: RunLink,
    /// Sink of the transverse moment.
    pub sink: RunLink,
    /// Regrouping of the mass on the joint's axis.
    pub regroup: RegroupChoice,
    /// Alignment of a leaf's frame.
    pub leaf: LeafAlignment,
    /// Unit of length of forces and accelerations (m).
    pub length_unit: f64,
}

/// One formulation of the equations of motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Formulation {
    /// Choices for each body.
    pub bodies: Vec<BodyChoices>,
}

impl Formulation {
    /// The plain recursive formulation.
    pub fn plain(count: usize) -> Self {
        let choices = BodyChoices {
            angular: AngularRoute::Acceleration,
            diagonal: Diagonal::Sums,
            by_acceleration: false,
            lift: Lift::Own,
            frame: WorkingFrame::Body,
            source: RunLink::Parent,
            sink: RunLink::Parent,
            regroup: RegroupChoice::Massless,
            leaf: LeafAlignment::NoOffset,
            length_unit: 1.0,
        };
        Self { bodies: vec![choices; count] }
    }

    /// The mechanism on a graph, in the form for this formulation.
    pub fn mechanism<'g>(&self, graph: &'g Graph, mechanism: &Mechanism<Number>) -> Mechanism<Scalar<'g>> {
        let regroup: Vec<_> = self.bodies.iter().map(|body| body.regroup).collect();
        let units: Vec<_> = self.bodies.iter().map(|body| body.length_unit).collect();
        let mut mechanism = mechanism.on(graph);
        for (index, choices) in self.bodies.iter().enumerate() {
            match choices.lift {
                Lift::Own => {}
                Lift::OfChildren => mechanism.leave_lift_to_children(index),
                Lift::OfParent => mechanism.leave_lift_to_parent(index),
            }
        }
        let mut mechanism = mechanism.regrouped(&regroup).in_length_units(&units);
        for (index, choices) in self.bodies.iter().enumerate() {
            match choices.leaf {
                LeafAlignment::NoOffset => {}
                LeafAlignment::FirstMoment => mechanism.align_first_moment(index),
                LeafAlignment::SecondMoment => mechanism.align_second_moment(index),
            }
        }
        mechanism
    }

    /// This formulation for massless bodies.
    pub fn massless(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.regroup = RegroupChoice::Massless);
        next
    }

    /// This formulation with all moments passed to the parent.
    pub fn without_shortcuts(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.sink = RunLink::Parent);
        next
    }

    /// This formulation with metres as unit of length.
    pub fn in_metres(&self) -> Self {
        self.with_unit(1.0)
    }

    /// This formulation with different choices for one body.
    pub(super) fn with_body(&self, index: usize, choices: BodyChoices) -> Self {
        let mut next = self.clone();
        next.bodies[index] = choices;
        next
    }

    /// This formulation with the same unit of length for all bodies.
    pub(super) fn with_unit(&self, unit: f64) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.length_unit = unit);
        next
    }
}

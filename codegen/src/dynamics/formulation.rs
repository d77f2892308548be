//! The ways in which the same equations can be written.

use crate::graph::{Graph, Scalar};
use crate::kinematics::{Mechanism, Number, RegroupChoice};

/// How the acceleration of the points of a body is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngularRoute {
    /// From the angular acceleration ω̇: U = ω̇× + ω× ω×.
    Acceleration,
    /// From the points of the joint's axis: they belong to parent and child, so U z turns like a vector. Then
    /// only ω, U z and the axial acceleration are carried along.
    AxisPoints,
}

/// How the diagonal of U is found, and its differences, which second moments multiply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagonal {
    /// The diagonal comes from squares of ω, the differences from the diagonal.
    Sums,
    /// Both come from squares of ω.
    Squares,
    /// As a sum over axis points. U_zz is known, so the square of ω_x is not needed.
    Axis,
    /// As `Axis`, without the square of ω_y.
    AxisAcross,
}

/// Where the way along a joint's axis to a body's origin belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lift {
    /// To the body: the origin is where the axes of its main child and its own are nearest.
    Own,
    /// To the body's children: its own origin is where the translation from its parent ends.
    OfChildren,
    /// To the translation from its parent.
    OfParent,
}

/// The frame in which a body's equations are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkingFrame {
    /// Its own.
    Body,
    /// The joint's frame before its motion: the inertia turns instead of the velocities.
    BeforeJoint,
}

/// Where quantities of a body in a run of parallel joints come from and go to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunLink {
    /// The parent.
    Parent,
    /// The base of the run, with the joint angles added before the sine.
    RunBase,
}

/// The free rotation of a leaf's frame about its own axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafAlignment {
    /// No angle offset.
    NoOffset,
    /// The first moment has no y component.
    FirstMoment,
    /// The second moment has no xy component.
    SecondMoment,
}

/// The choices for one body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyChoices {
    /// Route to U.
    pub angular: AngularRoute,
    /// Diagonal of U.
    pub diagonal: Diagonal,
    /// Whether U_zx comes from the component y of the angular acceleration, which the children may need
    /// anyway. Applies to axis points.
    pub by_acceleration: bool,
    /// The way along the axis.
    pub lift: Lift,
    /// Frame of the equations.
    pub frame: WorkingFrame,
    /// Where angular velocity and acceleration come from.
    pub source: RunLink,
    /// Where the transverse moment goes to.
    pub sink: RunLink,
    /// The use of the mass on the joint's axis.
    pub regroup: RegroupChoice,
    /// Alignment of a leaf's frame.
    pub leaf: LeafAlignment,
    /// Unit of length of forces and accelerations (m).
    pub length_unit: f64,
}

/// One formulation of the equations of motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Formulation {
    /// Choices per body.
    pub bodies: Vec<BodyChoices>,
}

impl Formulation {
    /// The plain recursive form.
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

    /// The mechanism on a graph, prepared for this formulation.
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

    /// This formulation with massless bodies.
    pub fn massless(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.regroup = RegroupChoice::Massless);
        next
    }

    /// This formulation with every moment passed on to the parent.
    pub fn without_shortcuts(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.sink = RunLink::Parent);
        next
    }

    /// This formulation in metres.
    pub fn in_metres(&self) -> Self {
        self.with_unit(1.0)
    }

    /// This formulation with another choice for one body.
    pub(super) fn with_body(&self, index: usize, choices: BodyChoices) -> Self {
        let mut next = self.clone();
        next.bodies[index] = choices;
        next
    }

    /// This formulation with one unit of length for all bodies.
    pub(super) fn with_unit(&self, unit: f64) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.length_unit = unit);
        next
    }
}

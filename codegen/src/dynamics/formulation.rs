//! Formulations: alternative ways to write the same equations of motion, which differ in the number of
//! operations.
//!
//! The matrix U = ω̇× + ω× ω× of a body with the angular velocity ω gives the acceleration a + U r of its
//! point r. Here a is the acceleration of the body's origin. The z axis of a body's frame is its joint's
//! axis.

use crate::graph::{Graph, Scalar};
use crate::kinematics::{Mechanism, Number, RegroupChoice};

/// Way to compute the matrix U = ω̇× + ω× ω× of a body with the angular velocity ω. A point r of the body has
/// the acceleration a + U r, with the acceleration a of the body's origin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngularRoute {
    /// Computes U = ω̇× + ω× ω× of a body from the angular acceleration ω̇.
    Acceleration,
    /// Computes U = ω̇× + ω× ω× from U z, with the unit vector z of the joint's axis. Points of the axis
    /// belong to both bodies of the joint, so U z transforms like a vector. Only ω, U z and the component of
    /// ω̇ along the axis have to be transformed from the parent.
    AxisPoints,
}

/// Way to compute the diagonal of the matrix U = ω̇× + ω× ω× of a body, and the differences of the diagonal
/// entries. These differences multiply second moments of mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagonal {
    /// The diagonal of the matrix ω̇× + ω× ω× is computed from squares of the components of ω. The
    /// differences of its entries are computed from the entries.
    Sums,
    /// The diagonal of the matrix ω̇× + ω× ω×, and the differences of its entries, are computed from squares
    /// of the components of ω.
    Squares,
    /// Computes the entry U_yy of U = ω̇× + ω× ω× from U_zz, `U_yy = U_zz + ω_y² − ω_z²`, so that ω_x² is not
    /// needed. This saves operations if U_zz is already known ([`AngularRoute::AxisPoints`]).
    Axis,
    /// Computes the entry U_xx of U = ω̇× + ω× ω× from U_zz, `U_xx = U_zz + ω_x² − ω_z²`, so that ω_y² is not
    /// needed. This saves operations if U_zz is already known ([`AngularRoute::AxisPoints`]).
    AxisAcross,
}

/// Assignment of the constant translation along a joint's axis. It determines the origin of the joint's body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Lift {
    /// The translation along the joint's axis belongs to the body. The body's origin is the point of its axis
    /// nearest to the axis of its main child.
    Own,
    /// The translation along the joint's axis belongs to the children of the body. The body's origin is at
    /// the end of the translation from the parent.
    OfChildren,
    /// The translation along the joint's axis is included in the translation from the parent.
    OfParent,
}

/// Frame in which a body's equations of motion are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorkingFrame {
    /// The equations are written in the body's own frame.
    Body,
    /// The equations are written in the joint's frame before the joint's motion. The inertia is rotated
    /// instead of the velocities.
    BeforeJoint,
}

/// Neighbour of a body among joints in sequence with parallel axes (a run). The body takes its velocities
/// from this neighbour, or passes its moment to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunLink {
    /// The body is coupled to its parent body.
    Parent,
    /// The body is coupled to the body before the run of parallel axes. The angles of the run's joints are
    /// added before the sine is computed.
    RunBase,
}

/// Rotation of the frame of a leaf (a body without children) about its joint's axis. The equations hold for
/// any such rotation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafAlignment {
    /// The leaf's frame is not rotated.
    NoOffset,
    /// The leaf's frame is rotated so that the first moment of mass has no y component.
    FirstMoment,
    /// The leaf's frame is rotated so that the second moment of mass has no xy component.
    SecondMoment,
}

/// Choices with which the equations of one body are written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyChoices {
    /// Way to compute the body's matrix U = ω̇× + ω× ω×.
    pub angular: AngularRoute,
    /// Way to compute the diagonal of the body's matrix U = ω̇× + ω× ω×.
    pub diagonal: Diagonal,
    /// Whether the entry U_zx of the matrix U = ω̇× + ω× ω× is computed from the y component of the angular
    /// acceleration. Children may need this component. Only has an effect with [`AngularRoute::AxisPoints`].
    pub by_acceleration: bool,
    /// Assignment of the translation along the joint's axis.
    pub lift: Lift,
    /// Frame in which the body's equations are written.
    pub frame: WorkingFrame,
    /// Body from which the angular velocity and acceleration are taken.
    pub source: RunLink,
    /// Body to which the moment perpendicular to the joint's axis is passed.
    pub sink: RunLink,
    /// Assignment of mass on the joint's axis to one of the joint's two bodies. It has no effect on the
    /// motion.
    pub regroup: RegroupChoice,
    /// Rotation of the body's frame about its joint's axis if the body has no children.
    pub leaf: LeafAlignment,
    /// Unit of length of the body's forces and accelerations \[m\]. A length that is equal to the unit
    /// becomes 1 and saves products.
    pub length_unit: f64,
}

/// One formulation of the equations of motion. Formulations differ in the number of operations, not in the
/// results.
#[derive(Debug, Clone, PartialEq)]
pub struct Formulation {
    /// Choices for each body of the robot.
    pub bodies: Vec<BodyChoices>,
}

impl Formulation {
    /// The usual recursive formulation of a mechanism with `count` bodies: equations in body frames and in
    /// metres. Velocities and moments are passed from joint to joint.
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

    /// Converts the mechanism's numbers to expressions of `graph`, in the frames, mass distribution and units
    /// of length of this formulation.
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

    /// This formulation with [`RegroupChoice::Massless`] for all bodies: as much mass as possible is assigned
    /// to the parent.
    pub fn massless(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.regroup = RegroupChoice::Massless);
        next
    }

    /// This formulation, but each body passes its whole moment to its parent. In a run of parallel axes, no
    /// part of the moment is passed directly to the body before the run.
    pub fn without_shortcuts(&self) -> Self {
        let mut next = self.clone();
        next.bodies.iter_mut().for_each(|body| body.sink = RunLink::Parent);
        next
    }

    /// This formulation with the metre as unit of length.
    pub fn in_metres(&self) -> Self {
        self.with_unit(1.0)
    }

    /// This formulation with other choices for one body.
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

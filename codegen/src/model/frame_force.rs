//! Forces, wrenches and inputs at frames.

use super::Pose;
use gelenk_formula::Formula;

/// Where a force acts: a frame fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// Name of the frame or link in the description.
    pub name: String,
    /// Link that carries it.
    pub link: usize,
    /// Its pose in that link's frame.
    pub pose: Pose,
}

/// A force between the origins of two frames, as of a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct PointForce {
    /// Name in the description, or the names of the two frames.
    pub name: String,
    /// The frames.
    pub between: [Attachment; 2],
    /// The force (N), positive where it pulls together, over the distance of the origins (m) as position and its
    /// rate (m/s) as velocity.
    pub law: Formula,
}

/// An input that is a force at frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceInput {
    /// Name in the description.
    pub name: String,
    /// Lowest and highest value; `None` if not described.
    pub limits: Option<[f64; 2]>,
    /// Effect of a unit of the input.
    pub effect: ForceEffect,
}

impl ForceInput {
    /// N where a unit of the input makes a force, else N m.
    pub(crate) fn unit(&self) -> &'static str {
        match &self.effect {
            ForceEffect::Wrench { wrench, .. } if wrench[..3].iter().all(Formula::is_zero) => "N m",
            ForceEffect::Wrench { .. } | ForceEffect::Pull(_) => "N",
        }
    }
}

/// Effect of a unit of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceEffect {
    /// A wrench, fixed in a frame: force (N), then moment about its origin (N m).
    Wrench {
        /// The frame.
        at: Attachment,
        /// Force and moment for a unit of the input.
        wrench: [Formula; 6],
    },
    /// A force (N) that pulls the origins of two frames together.
    Pull([Attachment; 2]),
}

/// A wrench that is an argument of functions: force (N), then moment about its frame's origin (N m).
#[derive(Debug, Clone, PartialEq)]
pub struct Wrench {
    /// Name in the description.
    pub name: String,
    /// The frame.
    pub at: Attachment,
    /// The axes of force and moment.
    pub axes: WrenchAxes,
}

/// Axes in which a wrench is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrenchAxes {
    /// Those of its frame.
    Frame,
    /// Those of the base.
    Base,
}

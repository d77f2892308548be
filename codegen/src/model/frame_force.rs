//! Forces, wrenches and inputs at frames.

use super::Pose;
use gelenk_formula::Formula;

/// A point of action: a frame fixed to a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Attachment {
    /// Name of the frame or link in the description.
    pub name: String,
    /// Index of the link that carries the frame.
    pub link: usize,
    /// Pose of the frame in the link's frame.
    pub pose: Pose,
}

/// A force between the origins of two frames, for example of a spring.
#[derive(Debug, Clone, PartialEq)]
pub struct PointForce {
    /// Name in the description, or the names of the two frames.
    pub name: String,
    /// The two frames.
    pub between: [Attachment; 2],
    /// Force law (N). The force is positive if it pulls the frames together. The position of the law is the
    /// distance of the origins (m), and the velocity is the rate of the distance (m/s).
    pub law: Formula,
}

/// An input that is a force at frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceInput {
    /// Name in the description.
    pub name: String,
    /// Lowest and highest value of the input; `None` without limits.
    pub limits: Option<[f64; 2]>,
    /// Effect of a unit of the input.
    pub effect: ForceEffect,
}

impl ForceInput {
    /// Unit of the input: N for a force, N m for a wrench whose force is zero.
    pub(crate) fn unit(&self) -> &'static str {
        match &self.effect {
            ForceEffect::Wrench { wrench, .. } if wrench[..3].iter().all(Formula::is_zero) => "N m",
            ForceEffect::Wrench { .. } | ForceEffect::Pull(_) => "N",
        }
    }
}

/// Effect of one unit of an input.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceEffect {
    /// A wrench fixed in a frame: force (N), then moment about the frame's origin (N m).
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
    /// Frame of the wrench.
    pub at: Attachment,
    /// Axes of force and moment.
    pub axes: WrenchAxes,
}

/// Axes in which a wrench is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrenchAxes {
    /// Axes of the frame.
    Frame,
    /// Axes of the base.
    Base,
}

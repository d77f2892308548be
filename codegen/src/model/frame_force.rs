//! Forces, wrenches and inputs at frames.

use super::Pose;
use gelenk_formula::Formula;

/// A frame fixed to a link, at which a force or a wrench acts.
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
    /// Name of the force in the description. A force without a name has the names of its two frames.
    pub name: String,
    /// The two frames. The force acts along the line between their origins.
    pub between: [Attachment; 2],
    /// Force law (N). A positive force pulls the frames together. In the law, `y` is the distance of the
    /// origins (m) and `v` is the rate of this distance (m/s).
    pub law: Formula,
}

/// An input that is a force at frames.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceInput {
    /// Name of the input in the description.
    pub name: String,
    /// Lowest and highest value of the input (N or N m); `None` without limits.
    pub limits: Option<[f64; 2]>,
    /// Force or wrench that one unit of the input exerts.
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

/// Force or wrench that one unit of an input exerts.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceEffect {
    /// A wrench fixed in a frame: force (N), then moment about the frame's origin (N m).
    Wrench {
        /// The frame in which the wrench is fixed.
        at: Attachment,
        /// Force (N) and moment (N m) for one unit of the input.
        wrench: [Formula; 6],
    },
    /// A force (N) that pulls the origins of two frames together.
    Pull([Attachment; 2]),
}

/// A wrench that is an argument of functions: force (N), then moment about its frame's origin (N m).
#[derive(Debug, Clone, PartialEq)]
pub struct Wrench {
    /// Name of the wrench in the description.
    pub name: String,
    /// Frame at whose origin the wrench acts.
    pub at: Attachment,
    /// Axes of the force and moment components.
    pub axes: WrenchAxes,
}

/// Axes in which a wrench is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WrenchAxes {
    /// Axes of the frame at which the wrench acts.
    Frame,
    /// Axes of the robot's base frame.
    Base,
}

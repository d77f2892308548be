//! A model in the formats of other programs. What a format cannot hold is said in notes, each thing by its name.

mod losses;
mod mjcf;
mod numbers;
mod urdf;
mod xml;

use crate::diagnostic::Diagnostics;
use crate::model::Model;

pub use xml::FIRST_LINE;

/// A format of robots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// MuJoCo's.
    Mjcf,
    /// That of ROS.
    Urdf,
}

impl Format {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Mjcf => "MJCF",
            Self::Urdf => "URDF",
        }
    }

    /// How the names of its files end.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Urdf => "urdf",
        }
    }
}

/// A file in another format.
#[derive(Debug, Clone, PartialEq)]
pub struct Exported {
    /// Its text.
    pub text: String,
    /// What the format does not hold of the robot.
    pub notes: Diagnostics,
}

/// Writes a model in another format, with the described values of its free parameters.
///
/// - `source`: the description as the head of the file names it
///
/// In MJCF the file has the robot's mass matrix and bias forces, but for rotors on bodies that move, which the notes name. A
/// URDF has no rotors at all.
#[must_use]
pub fn export(model: &Model, format: Format, source: &str) -> Exported {
    match format {
        Format::Mjcf => mjcf::export(model, source),
        Format::Urdf => urdf::export(model, source),
    }
}

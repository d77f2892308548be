//! A model in the formats of other programs. What a format cannot hold is said in notes, each thing by its name.

mod format;
mod losses;
mod mjcf;
mod names;
mod numbers;
mod urdf;
mod xml;

use crate::model::Model;

pub use format::{Exported, Format};
pub use xml::FIRST_LINE;

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

//! A model in the formats of other programs. What a format cannot hold is said in notes and warnings, each thing by its name.

mod format;
mod losses;
mod mjcf;
mod names;
mod numbers;
mod read_back;
mod urdf;
mod xml;

use crate::model::Model;

pub use format::{Exported, Format};
pub use xml::FIRST_LINE;

/// Writes a model in another format, with the described values of its free parameters.
///
/// - `source`: the description as the head of the file names it
///
/// The file is read back: where M or the bias forces differ from the model's at seeded states, a warning says by how much and
/// what was lost. In MJCF that are rotors on bodies that move; a URDF has no rotors at all.
#[must_use]
pub fn export(model: &Model, format: Format, source: &str) -> Exported {
    let (text, losses) = match format {
        Format::Mjcf => mjcf::export(model, source),
        Format::Urdf => urdf::export(model, source),
    };
    let difference = read_back::difference(model, format, &text);
    Exported { notes: losses.notes(difference), text }
}

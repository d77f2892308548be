//! Exports a model to formats of other programs. Notes and warnings name each part that a format cannot
//! represent.

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

/// Converts a model to the text of another format. Free parameters have the description's values.
///
/// - `source`: path of the description, for the comment at the top of the file
///
/// The text is read back. If the mass matrix or the bias forces differ from those of the model at
/// pseudo-random states, a warning names the difference and the lost parts. MJCF loses rotors on some moving
/// bodies. URDF loses all rotors.
#[must_use]
pub fn export(model: &Model, format: Format, source: &str) -> Exported {
    let (text, losses) = match format {
        Format::Mjcf => mjcf::export(model, source),
        Format::Urdf => urdf::export(model, source),
    };
    let difference = read_back::difference(model, format, &text);
    Exported { notes: losses.notes(difference), text }
}

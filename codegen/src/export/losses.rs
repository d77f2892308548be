//! What a format does not hold: one note for each kind, with the names of all that it concerns.

use super::format::Format;
use crate::diagnostic::{Diagnostic, Diagnostics};

/// Of motors whose torque falls with their speed.
pub(super) const LINE: &str = "has no torque–speed lines of motors; left out at";

/// Losses in the order in which they were found.
pub(super) struct Losses {
    format: Format,
    entries: Vec<(&'static str, Vec<String>)>,
}

impl Losses {
    pub(super) fn new(format: Format) -> Self {
        Self { format, entries: Vec::new() }
    }

    /// Remembers that something is lost.
    ///
    /// - `what`: what follows the format's name in the note
    pub(super) fn add(&mut self, what: &'static str, owner: &str) {
        let owner = format!("`{owner}`");
        match self.entries.iter_mut().find(|(known, _)| *known == what) {
            Some((_, owners)) if owners.contains(&owner) => {}
            Some((_, owners)) => owners.push(owner),
            None => self.entries.push((what, vec![owner])),
        }
    }

    /// The notes: unlike others they name every owner, since whoever reads the file must know.
    pub(super) fn notes(self) -> Diagnostics {
        let code = match self.format {
            Format::Mjcf => "not-in-mjcf",
            Format::Urdf => "not-in-urdf",
        };
        let name = self.format.name();
        let note = |(what, owners): (&'static str, Vec<String>)| {
            Diagnostic::note(code, format!("the {name} {what}: {}", owners.join(", ")))
        };
        Diagnostics::new(self.entries.into_iter().map(note).collect())
    }
}

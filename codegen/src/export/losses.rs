//! Losses of an export: parts of a robot that a format cannot represent. There is one note or warning per
//! kind of loss, with all names.

use super::format::Format;
use crate::diagnostic::{Diagnostic, Diagnostics};

/// Text about lost torque–speed lines of motors.
pub(super) const LINE: &str = "has no torque–speed lines of motors. They are omitted at";

/// Effect of lost parts on the exported robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Effect {
    /// The lost parts have no effect on the mass matrix and the bias forces.
    None,
    /// The exported robot may differ from the model.
    Robot,
    /// Other programs reject the exported file.
    Refusal,
}

/// Losses of an export, in the order in which they were found.
pub(super) struct Losses {
    format: Format,
    entries: Vec<(Effect, &'static str, Vec<String>)>,
}

impl Losses {
    pub(super) fn new(format: Format) -> Self {
        Self { format, entries: Vec::new() }
    }

    /// Records a loss that has no effect on the mass matrix and the bias forces.
    ///
    /// - `what`: text after the format's name in the note
    /// - `owner`: name of the joint, link or other part
    pub(super) fn add(&mut self, what: &'static str, owner: &str) {
        self.push(Effect::None, what, owner);
    }

    /// Records a loss that may change the mass matrix or the bias forces.
    pub(super) fn of_robot(&mut self, what: &'static str, owner: &str) {
        self.push(Effect::Robot, what, owner);
    }

    /// Records a part because of which other programs reject the file.
    pub(super) fn refused(&mut self, what: &'static str, owner: &str) {
        self.push(Effect::Refusal, what, owner);
    }

    fn push(&mut self, effect: Effect, what: &'static str, owner: &str) {
        let owner = format!("`{owner}`");
        match self.entries.iter_mut().find(|(_, known, _)| *known == what) {
            Some((.., owners)) if owners.contains(&owner) => {}
            Some((.., owners)) => owners.push(owner),
            None => self.entries.push((effect, what, vec![owner])),
        }
    }

    /// Converts the losses to notes and warnings. Unlike other notes, they list all names, because users of the
    /// file need all names.
    ///
    /// - `difference`: difference between the robot and the written file; `None` if there is no difference
    pub(super) fn notes(self, difference: Option<String>) -> Diagnostics {
        let (code, name) = match self.format {
            Format::Mjcf => ("not-in-mjcf", self.format.name()),
            Format::Urdf => ("not-in-urdf", self.format.name()),
        };
        let is_cause = |effect: Effect| difference.is_some() && effect == Effect::Robot;
        let (causes, others): (Vec<_>, Vec<_>) =
            self.entries.into_iter().partition(|entry| is_cause(entry.0));
        let says = |(_, what, owners): &(Effect, &str, Vec<String>)| {
            format!("the {name} {what}: {}", owners.join(", "))
        };
        let note = |entry: (Effect, &str, Vec<String>)| match entry {
            (Effect::Refusal, ..) => Diagnostic::warning(code, says(&entry)),
            _ => Diagnostic::note(code, says(&entry)),
        };
        let is_refused = others.iter().any(|entry| entry.0 == Effect::Refusal);
        let mut notes: Vec<Diagnostic> = others.into_iter().map(note).collect();
        notes.extend(difference.map(|difference| {
            let causes = match causes.is_empty() {
                true if is_refused => "other programs reject it as well".to_owned(),
                true => "the cause is unknown. Please report it".to_owned(),
                false => causes.iter().map(says).collect::<Vec<_>>().join("; "),
            };
            Diagnostic::warning(
                "exported-robot-differs",
                format!("the {name} differs from the robot ({difference}): {causes}"),
            )
        }));
        Diagnostics::new(notes)
    }
}

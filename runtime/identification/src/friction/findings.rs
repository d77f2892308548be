//! What is said about a law on the way to it: notes, doubts, and reasons to refuse it.

use super::super::digits::plain;
use super::task::FrictionData;

/// Share of samples beyond a limit of the description above which the data do not fit the joint.
const BEYOND_LIMITS: f64 = 0.01;

/// What is collected on the way.
pub(super) struct Findings<'a> {
    pub(super) data: &'a FrictionData<'a>,
    pub(super) unit: &'a str,
    pub(super) notes: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) refusals: Vec<String>,
}

impl<'a> Findings<'a> {
    pub(super) fn new(data: &'a FrictionData<'a>) -> Self {
        let notes = data.settings.to_vec();
        Self { data, unit: data.unit, notes, warnings: Vec::new(), refusals: Vec::new() }
    }

    pub(super) fn note(&mut self, text: String) {
        self.notes.push(text);
    }

    /// Names the terms that the law may be made of.
    pub(super) fn note_library(&mut self, terms: &[String], separate: bool, condition: f64) {
        let offsets = match (separate, self.data.one_offset) {
            (false, _) => "",
            (true, false) => " beside the offset of each run",
            (true, true) => " beside one offset of all runs",
        };
        self.note(format!("library [{}]{offsets}, condition number {condition:.1}", terms.join(", ")));
    }

    pub(super) fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    pub(super) fn refuse(&mut self, text: String) {
        self.refusals.push(text);
    }

    pub(super) fn judge(&mut self, held_out: Option<f64>, least: f64) {
        let Some(r) = held_out.filter(|r| *r < least) else { return };
        self.refuse(format!(
            "the law explains nothing: R² on left-out data is {r:.3}, and at least {least} is asked for. Record \
             motion with more speed and reversals, or leave the described friction as it is"
        ));
    }

    /// Refuses a law whose data lie beyond a described limit.
    pub(super) fn judge_limit(&mut self, what: &str, share: f64, [limit, largest]: [f64; 2], unit: &str) {
        if share > BEYOND_LIMITS {
            self.refuse(format!(
                "{:.1} % of the {what} exceed the described limit of {} {unit}, up to {}: the \
                 log's columns or units are not this joint's (--columns), or the description's limits are wrong",
                100.0 * share,
                plain(limit, 4),
                plain(largest, 4)
            ));
        }
    }

    /// Notes, warnings, and the reason to refuse the law.
    pub(super) fn texts(self) -> (Vec<String>, Vec<String>, Option<String>) {
        let refusal = (!self.refusals.is_empty()).then(|| self.refusals.join("; "));
        (self.notes, self.warnings, refusal)
    }
}

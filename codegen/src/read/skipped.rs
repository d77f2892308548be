//! Notes about skipped or changed parts of a file, with one note for each kind.

use std::collections::BTreeMap;

use crate::diagnostic::{Diagnostic, Report, Severity, Span};
use crate::wording::listed;

/// A kind of remark about a description. All its occurrences give one note.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Remark {
    severity: Severity,
    code: &'static str,
    text: &'static str,
}

impl Remark {
    pub(super) const fn note(code: &'static str, text: &'static str) -> Self {
        Self { severity: Severity::Note, code, text }
    }

    pub(super) const fn warning(code: &'static str, text: &'static str) -> Self {
        Self { severity: Severity::Warning, code, text }
    }
}

/// Remarks about skipped or changed parts of a file, collected while the file is read.
#[derive(Debug, Default)]
pub(super) struct Notes {
    /// Skipped elements and attributes, each with its first place and the number of its occurrences.
    skipped: BTreeMap<String, (Span, usize)>,
    /// For each kind of remark, its first place and the names of all elements that it concerns.
    remarks: BTreeMap<Remark, (Span, Vec<String>)>,
}

impl Notes {
    pub(super) fn skip(&mut self, what: String, span: Span) {
        self.skipped.entry(what).or_insert((span, 0)).1 += 1;
    }

    pub(super) fn remark(&mut self, remark: Remark, span: Span, owner: String) {
        let entry = self.remarks.entry(remark);
        entry.or_insert_with(|| (span, Vec::new())).1.push(owner);
    }

    /// Reports the collected remarks. Skipped elements that may affect the dynamics have a separate note.
    pub(super) fn report(self, is_harmless: impl Fn(&str) -> bool, report: &mut Report) {
        let (harmless, unknown): (Vec<_>, Vec<_>) =
            self.skipped.into_iter().partition(|(what, _)| is_harmless(what));
        note_skipped(harmless, report);
        note_unknown(unknown, report);
        for (remark, (span, owners)) in self.remarks {
            let message = format!("{}: {}", remark.text, listed(owners.into_iter()));
            let entry = Diagnostic { severity: remark.severity, ..Diagnostic::note(remark.code, message) };
            report.push(Some(span), entry);
        }
    }
}

fn note_skipped(harmless: Vec<(String, (Span, usize))>, report: &mut Report) {
    let spans = harmless.iter().map(|(_, (span, _))| *span);
    let Some(first) = spans.min_by_key(|span| span.start) else {
        return;
    };
    let counts = harmless.iter();
    let counts = counts.map(|(what, (_, count))| format!("{count} {what}"));
    let counts = counts.collect::<Vec<_>>().join(", ");
    let message = format!("elements without a known effect on the dynamics were skipped: {counts}");
    report.note(Some(first), "skipped", message);
}

fn note_unknown(unknown: Vec<(String, (Span, usize))>, report: &mut Report) {
    let spans = unknown.iter().map(|(_, (span, _))| *span);
    let Some(first) = spans.min_by_key(|span| span.start) else {
        return;
    };
    let entries = unknown.iter().map(|(what, (_, count))| match count {
        1 => what.clone(),
        count => format!("{what} ({count} times)"),
    });
    report.note(Some(first), "unknown-tag", format!("unknown entries were skipped: {}", listed(entries)));
}

//! Diagnostics: errors, warnings and notes about a description. Each has a place and a remedy if they are
//! known.
//!
//! Each stage returns either a correct value or [`Diagnostics`] with all problems that the stage found. A
//! [`Diagnostic`] has a copy of the source line, which terminal, build log and JSON show.

use crate::remedies::remedy;
use gelenk_findings::counted;
pub use gelenk_findings::{Finding as Diagnostic, Location, Severity};
pub(crate) use gelenk_formula::nearest;
use std::fmt;

/// Diagnostics sorted by place: file, line, column, code.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Diagnostics(Vec<Diagnostic>);

/// Largest number of printed diagnostics. A malicious file may cause a million of them.
const SHOWN: usize = 100;

impl Diagnostics {
    /// Sorts the diagnostics by place and removes duplicates. Diagnostics without a place come first.
    pub fn new(mut entries: Vec<Diagnostic>) -> Self {
        entries.sort_by(|a, b| key(a).cmp(&key(b)));
        entries.dedup();
        Self(entries)
    }

    /// The diagnostics in the order of their places.
    pub fn entries(&self) -> &[Diagnostic] {
        &self.0
    }

    /// Converts to the list of diagnostics, in the order of their places.
    pub fn into_entries(self) -> Vec<Diagnostic> {
        self.0
    }

    /// Whether the list has no diagnostics.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether one of the diagnostics is an error.
    pub fn has_errors(&self) -> bool {
        self.error_count() > 0
    }

    /// Number of diagnostics that are errors.
    pub fn error_count(&self) -> usize {
        self.0.iter().filter(|entry| entry.severity == Severity::Error).count()
    }
}

impl From<Diagnostic> for Diagnostics {
    fn from(entry: Diagnostic) -> Self {
        Self(vec![entry])
    }
}

fn key(entry: &Diagnostic) -> (Option<(&str, usize, usize)>, Severity, &str, &str) {
    let place = entry.location().map(|at| (at.file.as_str(), at.line, at.column));
    (place, entry.severity, entry.code, &entry.message)
}

impl fmt::Display for Diagnostics {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, entry) in self.0.iter().take(SHOWN).enumerate() {
            let separator = if index == 0 { "" } else { "\n\n" };
            write!(out, "{separator}{entry}")?;
        }
        match self.0.len().checked_sub(SHOWN) {
            Some(more) if more > 0 => write!(out, "\n\n… and {more} more"),
            _ => Ok(()),
        }
    }
}

impl std::error::Error for Diagnostics {}

/// A place in the texts of a [`Report`]: bytes `start..end` of one text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Span {
    /// Index of the text in its [`Report`].
    pub source: usize,
    /// Index of the first byte of the place.
    pub start: usize,
    /// Index after the last byte of the place.
    pub end: usize,
}

impl Span {
    /// Creates the span of the bytes `start..end` in the text with this index.
    pub fn new(source: usize, range: std::ops::Range<usize>) -> Self {
        Self { source, start: range.start, end: range.end }
    }
}

/// A value with its place in the text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct At<T> {
    /// The value that was read.
    pub value: T,
    /// Place from which the value was read.
    pub span: Span,
}

impl<T> At<T> {
    /// Creates a value with its place.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

/// A text that was read, with its name and the starts of its lines.
#[derive(Debug)]
struct Source {
    name: String,
    text: String,
    line_starts: Vec<usize>,
}

/// The texts that were read, and the diagnostics that were added so far.
#[derive(Debug, Default)]
pub(crate) struct Report {
    sources: Vec<Source>,
    entries: Vec<Diagnostic>,
    dropped: usize,
}

/// Largest number of diagnostics that a report keeps, because finding their places in very long lines takes
/// time.
const KEPT: usize = 1000;

impl Report {
    /// Adds a text with the name that messages show. Returns the text's index for [`Span`]s.
    pub fn add_source(&mut self, name: &str, text: &str) -> usize {
        let breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(at, _)| at + 1);
        let line_starts = std::iter::once(0).chain(breaks).collect();
        self.sources.push(Source { name: name.to_owned(), text: text.to_owned(), line_starts });
        self.sources.len() - 1
    }

    /// The characters of the text at a place; empty if the place lies outside the text.
    pub fn text(&self, span: Span) -> &str {
        self.sources.get(span.source).and_then(|source| source.text.get(span.start..span.end)).unwrap_or("")
    }

    /// Adds an error at a place in the text.
    pub fn error(&mut self, span: Span, code: &'static str, message: impl Into<String>) -> &mut Self {
        let entry = Diagnostic::error(code, message);
        self.push(Some(span), entry)
    }

    /// Adds a warning at a place in the text.
    pub fn warning(&mut self, span: Span, code: &'static str, message: impl Into<String>) -> &mut Self {
        let entry = Diagnostic::warning(code, message);
        self.push(Some(span), entry)
    }

    /// Adds a note, with or without a place in the text.
    pub fn note(&mut self, span: Option<Span>, code: &'static str, message: impl Into<String>) -> &mut Self {
        let entry = Diagnostic::note(code, message);
        self.push(span, entry)
    }

    /// Adds a diagnostic. If the report is full, an error is only counted.
    pub fn push(&mut self, span: Option<Span>, mut entry: Diagnostic) -> &mut Self {
        if self.is_full() && entry.severity == Severity::Error {
            self.dropped += 1;
            return self;
        }
        entry.about.place = span.and_then(|span| self.location(span)).or(entry.about.place);
        self.entries.push(entry);
        self
    }

    /// Sets the remedy of the diagnostic that was added last.
    pub fn help(&mut self, help: impl Into<String>) {
        if let Some(last) = self.entries.last_mut().filter(|_| self.dropped == 0) {
            last.remedy = Some(help.into());
        }
    }

    /// Number of errors, including the errors that were only counted.
    pub fn error_count(&self) -> usize {
        let errors = self.entries.iter().filter(|entry| entry.severity == Severity::Error);
        errors.count() + self.dropped
    }

    /// Whether the report is full. Further errors are then only counted.
    pub fn is_full(&self) -> bool {
        self.entries.len() >= KEPT
    }

    /// Whether an error was added to the report.
    pub fn has_errors(&self) -> bool {
        self.error_count() > 0
    }

    /// All diagnostics. An error without a remedy gets the remedy of its code.
    pub fn finish(mut self) -> Diagnostics {
        if self.dropped > 0 {
            let message = counted(self.dropped, "more problem is not shown", "more problems are not shown");
            self.entries.push(Diagnostic::error("too-many-problems", message));
        }
        for entry in self.entries.iter_mut().filter(|entry| entry.severity == Severity::Error) {
            entry.remedy = entry.remedy.take().or_else(|| remedy(entry.code).map(str::to_owned));
        }
        Diagnostics::new(self.entries)
    }

    /// Text `file:line:column` of a place, for messages with a second place; empty if the place is not in a
    /// text.
    pub fn place(&self, span: Span) -> String {
        self.location(span).map_or_else(String::new, |at| format!("{}:{}:{}", at.file, at.line, at.column))
    }

    fn location(&self, span: Span) -> Option<Location> {
        let source = self.sources.get(span.source)?;
        let start = floor_boundary(&source.text, span.start);
        let line = source.line_starts.partition_point(|first| *first <= start).max(1);
        let first = *source.line_starts.get(line - 1)?;
        let rest = source.text.get(first..)?;
        let text = rest.split('\n').next().unwrap_or("").trim_end_matches('\r');
        let column = source.text.get(first..start)?.chars().count().min(text.chars().count());
        let end = floor_boundary(&source.text, span.end.max(start));
        let marked = source.text.get(start..end).and_then(|marked| marked.split('\n').next()).unwrap_or("");
        let (excerpt, excerpt_column, length) = excerpt(text, column, marked.trim_end().chars().count());
        Some(Location {
            file: source.name.clone(),
            line,
            column: column + 1,
            length,
            excerpt,
            excerpt_column,
        })
    }
}

/// Largest number of characters of a line that are shown.
const WINDOW: usize = 120;

/// Returns the part of a line that is shown, the index of the marked column in this part, and the number of
/// marked characters.
fn excerpt(line: &str, column: usize, marked: usize) -> (String, usize, usize) {
    let skipped = if column + 20 > WINDOW { column - 20 } else { 0 };
    let visible = line.chars().skip(skipped).take(WINDOW);
    let excerpt: String = visible.map(|c| if c.is_control() { ' ' } else { c }).collect();
    let excerpt = excerpt.trim_end().to_owned();
    let room = excerpt.chars().count().saturating_sub(column - skipped);
    (excerpt, column - skipped, marked.min(room).max(1))
}

fn floor_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

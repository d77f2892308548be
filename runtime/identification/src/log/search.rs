//! The columns of one quantity: by the user's pattern, or by the best family of headers.

use super::super::error::Result;
use super::families::{Family, Targets, families};
use super::finder::Finder;
use super::options::Pattern;
use super::scale::factor;
use super::units::Unit;
use super::vocabulary::{Kind, Origin, is_number, meaning};
use super::wording::{order_said, plural, reason, singular};

/// A column and the factor that makes it SI.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Source {
    pub column: usize,
    pub factor: f64,
}

/// Columns of a quantity, how they were found, and what has to be said of them.
#[derive(Default)]
pub(super) struct Found {
    pub(super) columns: Vec<usize>,
    /// Units that the user names; empty where nobody does.
    pub(super) units: Vec<Option<Unit>>,
    pub(super) remarks: Vec<String>,
    /// Nothing that was measured is found, and nobody named these.
    pub(super) is_commanded: bool,
}

impl Found {
    /// The unit that the user names for a column.
    pub(super) fn unit(&self, index: usize) -> Option<Unit> {
        self.units.get(index).copied().flatten()
    }
}

impl Finder<'_> {
    pub(super) fn by_pattern(&self, pattern: &Pattern, targets: &Targets) -> Result<Found> {
        let chosen = pattern.resolve(self.headers, self.sheet.width, targets)?;
        Ok(Found { columns: chosen.columns, units: chosen.units, ..Found::default() })
    }

    pub(super) fn is_commanded(&self, columns: &[usize]) -> bool {
        let Some(header) = columns.first().and_then(|c| self.headers.get(*c)) else { return false };
        let words: Vec<&str> = header.words.iter().map(String::as_str).filter(|w| !is_number(w)).collect();
        meaning(&words).is_some_and(|m| m.origin == Origin::Commanded)
    }

    pub(super) fn families(&self, kinds: &[Kind], targets: &Targets) -> Vec<Family> {
        let mut all = families(self.headers, targets, self.listed);
        all.retain(|f| kinds.contains(&f.meaning.kind));
        all.sort_by_key(|f| (kinds.iter().position(|k| *k == f.meaning.kind), f.rank()));
        all
    }

    /// The best complete family.
    ///
    /// # Errors
    /// Two that are equally good.
    pub(super) fn best(&self, kinds: &[Kind], targets: &Targets) -> Result<Option<Found>> {
        let mut complete: Vec<(Family, Vec<usize>)> = Vec::new();
        for family in self.families(kinds, targets) {
            if let Some(columns) = family.complete()
                && complete.iter().all(|(_, known)| *known != columns)
            {
                complete.push((family, columns));
            }
        }
        let Some((family, columns)) = complete.first() else { return Ok(None) };
        let mut remarks = Vec::new();
        for (other, others) in complete.iter().skip(1) {
            if other.meaning.kind == family.meaning.kind && other.rank() == family.rank() {
                return Err(self.ambiguous(kinds[0], columns, others, targets));
            }
            remarks.push(format!(
                "Columns {} could be the {} too and were not taken: {}.",
                self.pattern_of(others, targets),
                plural(kinds[0]),
                reason(family, other)
            ));
        }
        remarks.extend(order_said(family, kinds[0]));
        let is_commanded = family.meaning.origin == Origin::Commanded;
        Ok(Some(Found { columns: columns.clone(), units: Vec::new(), remarks, is_commanded }))
    }

    /// Factors to SI, and a sentence for each column.
    pub(super) fn sources(
        &self,
        found: &Found,
        kind: Kind,
        targets: &Targets,
        sentences: &mut Vec<String>,
    ) -> Result<Vec<Source>> {
        let mut sources = Vec::with_capacity(found.columns.len());
        for (i, &column) in found.columns.iter().enumerate() {
            let (factor, unit) = factor(self, column, kind, i, found.unit(i))?;
            let what = if kind == Kind::Input || kind == Kind::Current { "input" } else { "joint" };
            sentences.push(format!(
                "Column {} is the {} of {what} {}, {unit}.",
                self.label(column),
                singular(kind),
                targets.names[i]
            ));
            sources.push(Source { column, factor });
        }
        Ok(sources)
    }
}

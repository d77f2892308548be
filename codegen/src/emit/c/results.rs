//! Prints the statements that write results.
//!
//! In code over several states, two adjacent entries are written at once, because processors can perform only
//! few stores per cycle.

use super::body::{Body, in_row};
use super::group;
use crate::program::{Operand, Shape};

impl Body<'_> {
    /// Statements that write all result entries for which `is_wanted` is true.
    pub(super) fn stores(&self, is_wanted: impl Fn(Operand) -> bool) -> Vec<String> {
        let outputs = self.program.outputs.iter().enumerate();
        let at_once = if self.over_lanes { 2 } else { 1 };
        let stores = outputs.flat_map(|(result, output)| {
            let wanted = output.entries.chunks(at_once).enumerate();
            let wanted = wanted.filter(|(_, entries)| entries.iter().all(|&entry| is_wanted(entry)));
            wanted.map(move |(index, _)| (result, index * at_once))
        });
        stores.map(|(result, first)| self.store(result, first)).collect()
    }

    /// Statements that write the value with this index to results, after the value's own statement.
    pub(super) fn stores_of(&self, index: usize) -> Vec<String> {
        let places = self.stored.get(index).into_iter().flatten();
        let stores = places.filter_map(|&(result, entry)| match self.over_lanes {
            true => self.store_pair_of(result, entry, index),
            false => Some(self.store(result, entry)),
        });
        stores.collect()
    }

    /// Statement that writes a new entry of a result together with its neighbour; `None` if the neighbour is
    /// computed later.
    ///
    /// - `index`: index of the new value
    fn store_pair_of(&self, result: usize, entry: usize, index: usize) -> Option<String> {
        let first = entry - entry % 2;
        let beside = self.program.outputs[result].entries.get(first + 1 - entry % 2);
        let is_known = match beside.and_then(|&beside| self.made(beside)) {
            None => true,
            Some(made) if made == index => entry == first,
            Some(made) => made < index,
        };
        is_known.then(|| self.store(result, first))
    }

    /// Statement that writes an entry of a result. In code over several states the next entry is written,
    /// too.
    fn store(&self, result: usize, first: usize) -> String {
        let (name, entries) = (&self.names.results[result], &self.program.outputs[result].entries);
        if self.over_lanes {
            let pair: Vec<String> = entries[first..].iter().take(2).map(|&entry| self.value(entry)).collect();
            return group::scatter(self.context, name, first, entries.len(), &pair);
        }
        format!("{} = {};", self.place(result, first), self.value(entries[first]))
    }

    fn place(&self, result: usize, entry: usize) -> String {
        let (output, name) = (&self.program.outputs[result], &self.names.results[result]);
        match (self.row, self.stride, output.shape) {
            (Some(len), _, _) => in_row(name, entry, len),
            (None, _, Shape::Scalar) => format!("*{name}"),
            (None, Some(stride), Shape::Matrix(_, columns)) => {
                format!("{name}[{}]", entry / columns.len * stride + entry % columns.len)
            }
            (None, _, _) => format!("{name}[{entry}]"),
        }
    }
}

//! Advice about unknown keys.

use super::{Key, Keys, ROBOT};
use crate::diagnostic::nearest;
use std::collections::VecDeque;

/// Help for an unknown key: a known key with another name, a key of an inner table, a key of another table,
/// or the nearest spelling. `None` without a similar key.
pub(crate) fn advice(unknown: &str, keys: &Keys) -> Option<String> {
    if let Some(row) = keys.rows().find(|row| row.also.contains(&unknown)) {
        return Some(format!("{}: {}", row.line(), row.says));
    }
    let inner = |row: &&Key| row.value.keys().is_some_and(|inner| inner.row(unknown).is_some());
    if let Some(row) = keys.rows().find(inner) {
        return Some(format!("`{unknown}` is a key of `{0}`: `{0} = {1}`", row.name, row.example));
    }
    if let Some((owner, row)) = elsewhere(unknown) {
        return Some(format!("`{unknown}` is a key of {}: {}", owner.what, row.line()));
    }
    nearest(unknown, keys.rows().map(|row| row.name))
}

/// The table that is nearest to the top level and has a key with this name, and the key.
fn elsewhere(name: &str) -> Option<(&'static Keys, &'static Key)> {
    let mut waiting = VecDeque::from([&ROBOT]);
    while let Some(keys) = waiting.pop_front() {
        if let Some(row) = keys.row(name) {
            return Some((keys, row));
        }
        waiting.extend(keys.rows().filter_map(|row| row.value.keys()));
    }
    None
}

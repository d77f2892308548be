//! Makes names distinct with appended numbers.

use std::collections::{BTreeMap, BTreeSet};

/// Names in use. Also contains the last number appended to each stem, because a search for it would take
/// quadratic time with thousands of equal names.
#[derive(Debug, Default)]
pub(crate) struct Distinct {
    taken: BTreeSet<String>,
    last: BTreeMap<String, usize>,
}

impl Distinct {
    /// Returns the wanted name if it is not in use, otherwise the name with a number: `wanted_2`. The result
    /// is then in use.
    pub(crate) fn take(&mut self, wanted: &str) -> String {
        self.take_by_stem(wanted, wanted)
    }

    /// Returns the wanted name, or the stem with a number if the wanted name is in use. The result is then in
    /// use.
    pub(crate) fn take_by_stem(&mut self, wanted: &str, stem: &str) -> String {
        let mut name = wanted.to_owned();
        while self.taken.contains(&name) {
            let last = self.last.entry(stem.to_owned()).or_insert(1);
            *last += 1;
            name = format!("{stem}_{last}");
        }
        self.taken.insert(name.clone());
        name
    }
}

impl FromIterator<String> for Distinct {
    fn from_iter<I: IntoIterator<Item = String>>(taken: I) -> Self {
        Self { taken: taken.into_iter().collect(), ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_names_are_told_apart() {
        let mut names = Distinct::from_iter(["a".to_owned(), "a_3".to_owned()]);
        let found: Vec<String> = (0..100_000).map(|_| names.take("a")).collect();
        assert_eq!(found[..3], ["a_2", "a_4", "a_5"]);
        assert_eq!(found.last().map(String::as_str), Some("a_100002"));
    }
}

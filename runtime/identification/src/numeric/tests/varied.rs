//! Levels with other values, for tests that vary them.

use super::Level;
use std::cell::Cell;
use std::fmt::Write;

thread_local! {
    /// The level that is varied, and the factor by which it is multiplied.
    static CHANGE: Cell<(&'static str, f64)> = const { Cell::new(("", 1.0)) };
}

/// A value that can be multiplied by a factor.
pub(crate) trait Varied: Copy {
    fn times(self, factor: f64) -> Self;
}

impl Varied for f64 {
    fn times(self, factor: f64) -> Self {
        factor * self
    }
}

impl Varied for usize {
    fn times(self, factor: f64) -> Self {
        (factor * self as f64).round().max(1.0) as Self
    }
}

impl<const N: usize> Varied for [f64; N] {
    fn times(self, factor: f64) -> Self {
        self.map(|value| factor * value)
    }
}

impl<T: Varied> Level<T> {
    pub(crate) fn get(&self) -> T {
        let (name, factor) = CHANGE.get();
        if name == self.name { self.value.times(factor) } else { self.value }
    }
}

/// Evaluates a function while a level has another value.
pub(crate) fn with<R>(name: &'static str, factor: f64, of: impl FnOnce() -> R) -> R {
    CHANGE.set((name, factor));
    let result = of();
    CHANGE.set(("", 1.0));
    result
}

/// Findings of named cases.
pub(crate) type Outcomes = Vec<(String, String)>;

/// Returns a page with the findings of the cases, and for each level the cases whose findings change if the level is halved
/// or doubled.
pub(crate) fn page<'n>(
    names: impl Iterator<Item = &'n &'static str>,
    outcomes: &dyn Fn() -> Outcomes,
) -> String {
    let usual = outcomes();
    let changed = |name: &'static str, factor: f64| {
        let other = with(name, factor, outcomes);
        let changed = usual.iter().zip(&other).filter(|(before, after)| before != after);
        let names: Vec<&str> = changed.map(|((name, _), _)| name.as_str()).collect();
        if names.is_empty() { "no change".to_owned() } else { names.join(", ") }
    };
    let mut page = String::new();
    usual.iter().for_each(|(name, found)| writeln!(page, "{name}: {found}").unwrap());
    for name in names {
        let [half, double] = [0.5, 2.0].map(|factor| changed(name, factor));
        let short = name.split("::").skip(1).collect::<Vec<_>>().join("::");
        writeln!(page, "{short} | {half} | {double}").unwrap();
    }
    page
}

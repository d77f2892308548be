//! Levels with other values, for tests that vary them.

use super::Level;
use std::cell::Cell;

thread_local! {
    /// The level that is varied, and the factor.
    static CHANGE: Cell<(&'static str, f64)> = const { Cell::new(("", 1.0)) };
}

/// A number that a factor changes.
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

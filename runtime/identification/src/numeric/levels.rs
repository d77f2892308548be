//! Numbers that decide. Each stage has its own in the file `levels.rs`, with the reason for their size; `estimation/tests/levels.rs` halves
//! and doubles them. Bounds of rounding are where they are used.

/// A number that decides.
pub(crate) struct Level<T> {
    /// Path of its name.
    #[cfg(test)]
    pub(crate) name: &'static str,
    pub(crate) value: T,
}

#[cfg(not(test))]
impl<T: Copy> Level<T> {
    pub(crate) fn get(&self) -> T {
        self.value
    }
}

/// Levels, as `NAME: TYPE = VALUE;` with their documentation.
macro_rules! levels {
    ($($(#[$documentation:meta])* $name:ident: $kind:ty = $value:expr;)*) => {
        $($(#[$documentation])* pub(crate) static $name: $crate::numeric::levels::Level<$kind> = $crate::numeric::levels::Level {
            #[cfg(test)]
            name: concat!(module_path!(), "::", stringify!($name)),
            value: $value,
        };)*

        /// All of them.
        #[cfg(test)]
        pub(crate) const NAMES: &[&str] = &[$($name.name),*];
    };
}
pub(crate) use levels;

#[cfg(test)]
pub(crate) mod varied {
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
}

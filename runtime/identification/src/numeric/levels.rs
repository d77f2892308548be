//! Levels: thresholds that decide on a choice or a finding. Each stage has its levels in a file `levels.rs`, with the
//! reason for their size. The tests in `estimation/tests/levels.rs` halve and double each level. Bounds of rounding errors
//! are defined next to the code that uses them.

/// A level: a threshold that decides on a choice or a finding.
pub(crate) struct Level<T> {
    /// Full path of the level's item.
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

/// Defines levels, each as `NAME: TYPE = VALUE;` with its documentation.
macro_rules! levels {
    ($($(#[$documentation:meta])* $name:ident: $kind:ty = $value:expr;)*) => {
        $($(#[$documentation])* pub(crate) static $name: $crate::numeric::levels::Level<$kind> = $crate::numeric::levels::Level {
            #[cfg(test)]
            name: concat!(module_path!(), "::", stringify!($name)),
            value: $value,
        };)*

        /// Names of all levels.
        #[cfg(test)]
        pub(crate) const NAMES: &[&str] = &[$($name.name),*];
    };
}
pub(crate) use levels;

#[cfg(test)]
#[path = "tests/varied.rs"]
pub(crate) mod varied;

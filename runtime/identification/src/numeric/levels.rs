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
#[path = "tests/varied.rs"]
pub(crate) mod varied;

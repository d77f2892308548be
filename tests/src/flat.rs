//! Generated functions behind one signature, so that tests can call them by name.
//!
//! This file is also pasted next to modules that a test compiles by itself: it uses `core` and `std` alone.

/// A generated function: input arrays and values of the free parameters in, all results out, rows first.
pub type Call = fn(&[Vec<f64>], &[f64]) -> Vec<f64>;

/// Name and functions of a robot; each function with its name.
pub type Robot = (&'static str, &'static [(&'static str, Call)]);

/// A number type of generated code.
pub trait Scalar: Copy {
    /// Rounded from f64.
    fn from_f64(x: f64) -> Self;
    /// Exact in f64.
    fn to_f64(self) -> f64;
}

impl Scalar for f64 {
    fn from_f64(x: f64) -> Self {
        x
    }
    fn to_f64(self) -> f64 {
        self
    }
}

impl Scalar for f32 {
    fn from_f64(x: f64) -> Self {
        x as Self
    }
    fn to_f64(self) -> f64 {
        Self::into(self)
    }
}

/// An entry of an argument: a number or a row of numbers.
pub trait Entry {
    /// Number of scalars.
    const NUMBERS: usize;
    /// The entry of [`Self::NUMBERS`] scalars.
    fn from_numbers(x: &[f64]) -> Self;
}

macro_rules! number_entries {
    ($($number:ty),*) => {$(
        impl Entry for $number {
            const NUMBERS: usize = 1;
            fn from_numbers(x: &[f64]) -> Self {
                Self::from_f64(x[0])
            }
        }
    )*};
}
number_entries!(f64, f32);

impl<T: Scalar, const L: usize> Entry for [T; L] {
    const NUMBERS: usize = L;
    fn from_numbers(x: &[f64]) -> Self {
        core::array::from_fn(|i| T::from_f64(x[i]))
    }
}

/// An argument of `N` entries.
///
/// # Panics
/// Where the slice is shorter.
pub fn array<E: Entry, const N: usize>(x: &[f64]) -> [E; N] {
    assert_eq!(x.len(), N * E::NUMBERS, "numbers of an argument");
    core::array::from_fn(|i| E::from_numbers(&x[i * E::NUMBERS..(i + 1) * E::NUMBERS]))
}

/// A value of a free parameter.
pub fn number<T: Scalar>(x: f64) -> T {
    T::from_f64(x)
}

/// A result to be written to.
pub trait Blank {
    /// NaN everywhere, so that an entry which is not written shows.
    fn blank() -> Self;
}

impl Blank for f64 {
    fn blank() -> Self {
        Self::NAN
    }
}

impl Blank for f32 {
    fn blank() -> Self {
        Self::NAN
    }
}

impl<T: Blank, const N: usize> Blank for [T; N] {
    fn blank() -> Self {
        core::array::from_fn(|_| T::blank())
    }
}

/// A result to be written to.
pub fn blank<T: Blank>() -> T {
    T::blank()
}

/// A result: a number, arrays of results, or a tuple of them.
pub trait Flat {
    /// Appends all numbers in their order.
    fn flatten(&self, into: &mut Vec<f64>);
}

macro_rules! flat_numbers {
    ($($number:ty),*) => {$(
        impl Flat for $number {
            fn flatten(&self, into: &mut Vec<f64>) {
                into.push(self.to_f64());
            }
        }
    )*};
}
flat_numbers!(f64, f32);

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flatten(&self, into: &mut Vec<f64>) {
        self.iter().for_each(|entry| entry.flatten(into));
    }
}

macro_rules! flat_tuples {
    ($(($($entry:ident $index:tt),*))*) => {$(
        impl<$($entry: Flat),*> Flat for ($($entry,)*) {
            fn flatten(&self, into: &mut Vec<f64>) {
                $(self.$index.flatten(into);)*
            }
        }
    )*};
}
flat_tuples! {
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3)
    (A 0, B 1, C 2, D 3, E 4)
}

/// All numbers of a result.
pub fn flat(result: &impl Flat) -> Vec<f64> {
    let mut numbers = Vec::new();
    result.flatten(&mut numbers);
    numbers
}

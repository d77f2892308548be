//! Generated input matrices, with or without the coordinates as an argument, and ranges of inputs.
//!
//! A module has `input_matrix()`, or `input_matrix(y)` if inputs act at frames. The macro
//! [`dynamics!`](crate::dynamics!) cannot distinguish them; the compiler selects the implementation that fits
//! the function.

use super::friction_law::Coordinates;
use super::functions::Missing;

/// A generated `input_matrix`. `Arguments` tells the implementations apart and is inferred.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate it with input_matrix",
    note = "a type of a module with free parameters is `struct Name {{ parameters }} = module`, otherwise \
            `struct Name = module`"
)]
pub trait InputMatrix<Arguments, const N: usize, const M: usize, const NY: usize> {
    /// B at positions `y`.
    fn at(&self, y: &[f64; NY]) -> [[f64; M]; N];
}

impl<F: Fn() -> [[f64; M]; N], const N: usize, const M: usize, const NY: usize> InputMatrix<(), N, M, NY>
    for F
{
    #[inline]
    fn at(&self, _: &[f64; NY]) -> [[f64; M]; N] {
        self()
    }
}

impl<F: Fn(&[f64; NY]) -> [[f64; M]; N], const N: usize, const M: usize, const NY: usize>
    InputMatrix<(Coordinates,), N, M, NY> for F
{
    #[inline]
    fn at(&self, y: &[f64; NY]) -> [[f64; M]; N] {
        self(y)
    }
}

/// A generated `input_matrix` of a module with free parameters `P`; or with driven joints, whose motion then is `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate it with input_matrix",
    note = "a type of a module with free parameters is `struct Name {{ parameters }} = module`, otherwise \
            `struct Name = module`"
)]
pub trait InputMatrixWithParameters<Arguments, P, const N: usize, const M: usize, const NY: usize> {
    /// B at positions `y`.
    fn at(&self, y: &[f64; NY], p: &P) -> [[f64; M]; N];
}

impl<F: Fn(&P) -> [[f64; M]; N], P, const N: usize, const M: usize, const NY: usize>
    InputMatrixWithParameters<(), P, N, M, NY> for F
{
    #[inline]
    fn at(&self, _: &[f64; NY], p: &P) -> [[f64; M]; N] {
        self(p)
    }
}

impl<F, P, const N: usize, const M: usize, const NY: usize>
    InputMatrixWithParameters<(Coordinates,), P, N, M, NY> for F
where
    F: Fn(&[f64; NY], &P) -> [[f64; M]; N],
{
    #[inline]
    fn at(&self, y: &[f64; NY], p: &P) -> [[f64; M]; N] {
        self(y, p)
    }
}

/// Input matrices of robots with driven joints and constant gear ratios.
impl<F: Fn() -> [[f64; M]; N], P, const N: usize, const M: usize, const NY: usize>
    InputMatrixWithParameters<((),), P, N, M, NY> for F
{
    #[inline]
    fn at(&self, _: &[f64; NY], _: &P) -> [[f64; M]; N] {
        self()
    }
}

/// A generated `input_matrix` of a module with driven joints and free parameters `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate it with input_matrix"
)]
pub trait InputMatrixWithDriven<Arguments, D, P, const N: usize, const M: usize, const NY: usize> {
    /// B at positions `y` and driven joints `d`.
    fn at(&self, y: &[f64; NY], d: &D, p: &P) -> [[f64; M]; N];
}

impl<F, D, P, const N: usize, const M: usize, const NY: usize> InputMatrixWithDriven<(), D, P, N, M, NY> for F
where
    F: Fn(&P) -> [[f64; M]; N],
{
    #[inline]
    fn at(&self, _: &[f64; NY], _: &D, p: &P) -> [[f64; M]; N] {
        self(p)
    }
}

impl<F, D, P, const N: usize, const M: usize, const NY: usize>
    InputMatrixWithDriven<(Coordinates,), D, P, N, M, NY> for F
where
    F: Fn(&[f64; NY], &D, &P) -> [[f64; M]; N],
{
    #[inline]
    fn at(&self, y: &[f64; NY], d: &D, p: &P) -> [[f64; M]; N] {
        self(y, d, p)
    }
}

/// `INPUT_RANGES` of the module, or [`Missing`] if its limits are only magnitudes.
pub trait InputRanges<const M: usize> {
    /// Ranges cut off at these magnitudes.
    fn within(&self, magnitudes: [f64; M]) -> [[f64; 2]; M];
}

impl<const M: usize> InputRanges<M> for [[f64; 2]; M] {
    fn within(&self, magnitudes: [f64; M]) -> [[f64; 2]; M] {
        core::array::from_fn(|j| {
            let [low, high] = self[j];
            [low.max(-magnitudes[j]), high.min(magnitudes[j])]
        })
    }
}

impl<const M: usize> InputRanges<M> for Missing {
    fn within(&self, magnitudes: [f64; M]) -> [[f64; 2]; M] {
        magnitudes.map(|limit| [-limit, limit])
    }
}

/// Number of drives for modules that do not define it: all inputs are drives.
pub const ALL_DRIVES: usize = usize::MAX;

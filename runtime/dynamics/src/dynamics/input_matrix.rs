//! Traits for generated functions `input_matrix` with different arguments, and for ranges of inputs.
//!
//! A module has `input_matrix()`, or `input_matrix(y)` if inputs act at frames. The macro [`dynamics!`](crate::dynamics!) cannot
//! distinguish these functions. The compiler selects the implementation of a trait by the type of the function.

use super::friction_law::Coordinates;
use super::functions::Missing;

/// A generated function `input_matrix`. The type `Arguments` distinguishes the implementations and is
/// inferred.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate this module with the function input_matrix",
    note = "if the module has free parameters, write `dynamics!(struct Name {{ parameters }} = module)`. If the \
            module has driven joints, write `dynamics!(struct Name {{ driven }} = module)`. If it has both, write \
            `{{ driven, parameters }}`. For all other modules, write `dynamics!(struct Name = module)`"
)]
pub trait InputMatrix<Arguments, const N: usize, const M: usize, const NY: usize> {
    /// Input matrix B at positions `y`.
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

/// A generated function `input_matrix` of a module with free parameters `P`, or of a module with driven
/// joints. In the second case `P` is the motion of the driven joints.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate this module with the function input_matrix",
    note = "if the module has free parameters, write `dynamics!(struct Name {{ parameters }} = module)`. If the \
            module has driven joints, write `dynamics!(struct Name {{ driven }} = module)`. If it has both, write \
            `{{ driven, parameters }}`. For all other modules, write `dynamics!(struct Name = module)`"
)]
pub trait InputMatrixWithParameters<Arguments, P, const N: usize, const M: usize, const NY: usize> {
    /// Input matrix B at positions `y`, with parameters or driven joints `p`.
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

/// Implementation for robots with driven joints and constant gear ratios.
impl<F: Fn() -> [[f64; M]; N], P, const N: usize, const M: usize, const NY: usize>
    InputMatrixWithParameters<((),), P, N, M, NY> for F
{
    #[inline]
    fn at(&self, _: &[f64; NY], _: &P) -> [[f64; M]; N] {
        self()
    }
}

/// A generated function `input_matrix` of a module with driven joints and free parameters `P`.
#[diagnostic::on_unimplemented(
    message = "the module has no `input_matrix`",
    label = "generate this module with the function input_matrix"
)]
pub trait InputMatrixWithDriven<Arguments, D, P, const N: usize, const M: usize, const NY: usize> {
    /// Input matrix B at positions `y`, with driven joints `d` and parameters `p`.
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

/// Ranges of the inputs of a module. The type of the constant `INPUT_RANGES` implements this trait. [`Missing`] implements it for
/// modules whose input limits are symmetric.
pub trait InputRanges<const M: usize> {
    /// Lowest and highest value of each input, limited to these magnitudes.
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

/// Value of `DRIVES` for modules without this constant, in which all inputs are drives.
pub const ALL_DRIVES: usize = usize::MAX;

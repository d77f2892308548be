//! Lanes: vectors of four or eight numbers.
//!
//! A vector of length `n` is stored as `⌈n/W⌉` lanes of W numbers, padded with zeros. A matrix is a sequence of these
//! vectors, which are its rows or its columns. The padding remains zero in every operation of this module, so no kernel
//! needs a loop for the remainder. The method is generic over the lanes. [`Portable`] uses the vector instructions for which
//! the crate is compiled. [`Avx2`](super::x86::Avx2) and [`Avx512`](super::x86::Avx512) use the instructions of newer x86-64
//! processors. The construction of a solver selects one of the three.

#[cfg(not(feature = "std"))]
use crate::no_std::*;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Number of floating-point numbers in a lane of [`Portable`] and [`Avx2`](super::x86::Avx2).
pub(crate) const WIDTH: usize = 4;
/// Largest number of floating-point numbers in a lane.
pub(super) const MAX_WIDTH: usize = 8;

/// Lanes that need no processor features beyond those for which the crate is compiled.
pub(crate) type Portable = wide::f64x4;

/// Runs a block in a separate function that is compiled for the instructions of the lanes: `vectorized!(V, { … })`. All
/// computations with lanes are in such blocks, because outside of these blocks each operation would be a function call. One
/// large function for the whole method would take minutes to compile.
macro_rules! vectorized {
    ($lanes:ty, $block:block) => {
        <$lanes as $crate::qp::lanes::Vector>::vectorized(
            #[inline(always)]
            || $block,
        )
    };
}
pub(crate) use vectorized;

/// Vector of [`Self::WIDTH`] numbers. All functions are inlined, so that they become instructions of the calling function.
pub(crate) trait Vector:
    bytemuck::Pod
    + core::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
{
    /// Numbers per vector.
    const WIDTH: usize;

    fn splat(value: f64) -> Self;
    /// `self · factor + term`, rounded once if the processor has fused multiply-add.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// `term − self · factor`.
    fn mul_neg_add(self, factor: Self, term: Self) -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    /// The larger numbers; unspecified if a number is NaN.
    fn fast_max(self, other: Self) -> Self;
    /// The smaller numbers; unspecified if a number is NaN.
    fn fast_min(self, other: Self) -> Self;
    fn reduce_add(self) -> f64;
    /// Calls `work` in a function that is compiled for these lanes, see [`vectorized!`].
    fn vectorized<R>(work: impl FnOnce() -> R) -> R;
    /// Transposes the square matrix whose rows are the first `WIDTH` vectors of `rows`.
    fn transpose(rows: &mut [Self]);

    #[inline(always)]
    fn zero() -> Self {
        Self::zeroed()
    }
    /// Numbers of `yes` if `of` is positive, and of `no` otherwise.
    #[inline(always)]
    fn select_positive(of: Self, yes: Self, no: Self) -> Self {
        let mut chosen = [no];
        let (of, yes) = ([of], [yes]);
        for i in 0..Self::WIDTH {
            if flat(&of)[i] > 0.0 {
                flat_mut(&mut chosen)[i] = flat(&yes)[i];
            }
        }
        chosen[0]
    }
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
}

impl Vector for Portable {
    const WIDTH: usize = WIDTH;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::splat(value)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }
    #[inline(always)]
    fn mul_neg_add(self, factor: Self, term: Self) -> Self {
        self.mul_neg_add(factor, term)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn fast_max(self, other: Self) -> Self {
        self.fast_max(other)
    }
    #[inline(always)]
    fn fast_min(self, other: Self) -> Self {
        self.fast_min(other)
    }
    #[inline(always)]
    fn reduce_add(self) -> f64 {
        self.reduce_add()
    }
    #[inline(always)]
    fn transpose(rows: &mut [Self]) {
        let transposed = Self::transpose([rows[0], rows[1], rows[2], rows[3]]);
        rows[..WIDTH].copy_from_slice(&transposed);
    }
    #[inline(never)]
    fn vectorized<R>(work: impl FnOnce() -> R) -> R {
        work()
    }
}

/// Number of lanes for `n` numbers.
pub(super) const fn lanes<V: Vector>(n: usize) -> usize {
    n.div_ceil(V::WIDTH)
}

/// Vector of `n` lanes with the value zero.
pub(super) fn zeros<V: Vector>(n: usize) -> Vec<V> {
    vec![V::zero(); n]
}

/// The number at position `i` of a padded vector.
#[inline(always)]
pub(super) fn at<V: Vector>(v: &[V], i: usize) -> f64 {
    flat(v)[i]
}

/// Writes `values` into a padded vector. The padding is not changed.
#[inline(always)]
pub(super) fn pack<V: Vector>(v: &mut [V], values: &[f64]) {
    flat_mut(v)[..values.len()].copy_from_slice(values);
}

/// The numbers of a padded vector, padding included.
#[inline(always)]
pub(crate) fn flat<V: Vector>(v: &[V]) -> &[f64] {
    bytemuck::cast_slice(v)
}

/// The mutable numbers of a padded vector, padding included.
#[inline(always)]
pub(crate) fn flat_mut<V: Vector>(v: &mut [V]) -> &mut [f64] {
    bytemuck::cast_slice_mut(v)
}

/// Inner product `Σ_r a[r] · b[r]` of padded vectors.
#[inline(always)]
pub(super) fn dot<V: Vector>(a: &[V], b: &[V]) -> f64 {
    let mut sum = a[0] * b[0];
    for r in 1..a.len().min(b.len()) {
        sum = a[r].mul_add(b[r], sum);
    }
    sum.reduce_add()
}

/// Vector of the sums of the vectors `of(0)`, `of(1)`, …
#[inline(always)]
pub(super) fn reduce_each<V: Vector>(of: impl Fn(usize) -> V) -> V {
    let mut rows = [V::zero(); MAX_WIDTH];
    for i in 0..V::WIDTH {
        rows[i] = of(i);
    }
    V::transpose(&mut rows);
    let sum = (rows[0] + rows[1]) + (rows[2] + rows[3]);
    if V::WIDTH == WIDTH { sum } else { sum + ((rows[4] + rows[5]) + (rows[6] + rows[7])) }
}

/// Largest number of a lane.
#[inline(always)]
pub(crate) fn largest<V: Vector>(v: V) -> f64 {
    let v = [v];
    let pairs = flat(&v).chunks_exact(2).map(|pair| pair[0].max(pair[1]));
    pairs.reduce(f64::max).unwrap_or_default()
}

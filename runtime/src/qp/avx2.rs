//! Vectors of four numbers in the 256-bit registers of x86-64 processors with AVX2 and fused multiply-add.

use super::lanes::{Vector, WIDTH};
use core::arch::x86_64::*;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Four numbers in one register. Values of this type only exist in solvers that were constructed after [`available`]
/// returned true. Every operation relies on this condition.
#[derive(Debug, Clone, Copy)]
#[repr(transparent)]
pub(crate) struct Avx2(__m256d);

// SAFETY: the type is transparent over a type that is `Zeroable` and `Pod`.
unsafe impl bytemuck::Zeroable for Avx2 {}
// SAFETY: as above.
unsafe impl bytemuck::Pod for Avx2 {}

/// Whether this processor has AVX2 and fused multiply-add.
pub(crate) fn available() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}

macro_rules! operator {
    ($trait:ident, $function:ident, $intrinsic:ident) => {
        impl $trait for Avx2 {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

operator!(Add, add, _mm256_add_pd);
operator!(Sub, sub, _mm256_sub_pd);
operator!(Mul, mul, _mm256_mul_pd);
operator!(Div, div, _mm256_div_pd);

impl AddAssign for Avx2 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Avx2 {
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) })
    }
    type Output = Self;
}

/// Calls `work` in a function that is compiled for AVX2 with fused multiply-add.
#[target_feature(enable = "avx2,fma")]
#[inline(never)]
fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    work()
}

impl Vector for Avx2 {
    #[inline(always)]
    fn vectorized<R>(work: impl FnOnce() -> R) -> R {
        // SAFETY: see the type.
        unsafe { vectorized(work) }
    }
    #[inline(always)]
    fn splat(value: f64) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_fmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn mul_neg_add(self, factor: Self, term: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_fnmadd_pd(self.0, factor.0, term.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn fast_max(self, other: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn fast_min(self, other: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn select_positive(of: Self, yes: Self, no: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_GT_OQ>(of.0, _mm256_setzero_pd())) })
    }
    #[inline(always)]
    fn reduce_add(self) -> f64 {
        // SAFETY: see the type.
        unsafe {
            let half = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }
    #[inline(always)]
    fn transpose(v: [Self; WIDTH]) -> [Self; WIDTH] {
        // SAFETY: see the type.
        unsafe {
            let (a, b) = (_mm256_unpacklo_pd(v[0].0, v[1].0), _mm256_unpackhi_pd(v[0].0, v[1].0));
            let (c, d) = (_mm256_unpacklo_pd(v[2].0, v[3].0), _mm256_unpackhi_pd(v[2].0, v[3].0));
            [
                Self(_mm256_permute2f128_pd::<0x20>(a, c)),
                Self(_mm256_permute2f128_pd::<0x20>(b, d)),
                Self(_mm256_permute2f128_pd::<0x31>(a, c)),
                Self(_mm256_permute2f128_pd::<0x31>(b, d)),
            ]
        }
    }
}

//! Vectors in the registers of newer x86-64 processors.

use super::lanes::{Vector, WIDTH};
use core::arch::x86_64::*;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Whether this processor has AVX2 and fused multiply-add.
pub(crate) fn has_avx2() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}

/// Whether this processor has AVX-512, AVX2 and fused multiply-add.
pub(super) fn has_avx512() -> bool {
    has_avx2() && std::is_x86_feature_detected!("avx512f")
}

macro_rules! operator {
    ($vector:ident, $trait:ident, $function:ident, $intrinsic:ident) => {
        impl $trait for $vector {
            type Output = Self;
            #[inline(always)]
            fn $function(self, other: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

/// Implements [`Vector`] for `$vector`. The last block has the functions that differ by more than the names of the intrinsics.
macro_rules! vector {
    (
        $(#[$comment:meta])*
        $vector:ident($register:ident, $width:expr, $features:literal),
        [$add:ident, $sub:ident, $mul:ident, $div:ident, $max:ident, $min:ident],
        [$set1:ident, $sqrt:ident, $fmadd:ident, $fnmadd:ident],
        $($different:item)*
    ) => {
        $(#[$comment])*
        #[derive(Debug, Clone, Copy)]
        #[repr(transparent)]
        pub(crate) struct $vector($register);

        // SAFETY: the type is transparent over a type that is `Zeroable` and `Pod`.
        unsafe impl bytemuck::Zeroable for $vector {}
        // SAFETY: as above.
        unsafe impl bytemuck::Pod for $vector {}

        operator!($vector, Add, add, $add);
        operator!($vector, Sub, sub, $sub);
        operator!($vector, Mul, mul, $mul);
        operator!($vector, Div, div, $div);

        impl AddAssign for $vector {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }

        impl Neg for $vector {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::splat(-0.0) - self
            }
        }

        impl Vector for $vector {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn vectorized<R>(work: impl FnOnce() -> R) -> R {
                #[target_feature(enable = $features)]
                #[inline(never)]
                fn compiled<R>(work: impl FnOnce() -> R) -> R {
                    work()
                }
                // SAFETY: see the type.
                unsafe { compiled(work) }
            }
            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $set1(value) })
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $fmadd(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn mul_neg_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $fnmadd(self.0, factor.0, term.0) })
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn fast_max(self, other: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $max(self.0, other.0) })
            }
            #[inline(always)]
            fn fast_min(self, other: Self) -> Self {
                // SAFETY: see the type.
                Self(unsafe { $min(self.0, other.0) })
            }
            $(#[inline(always)] $different)*
        }
    };
}

vector! {
    /// Four numbers in one register. Values of this type only exist in solvers that were constructed after [`has_avx2`]
    /// returned true. Every operation relies on this condition.
    Avx2(__m256d, WIDTH, "avx2,fma"),
    [_mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd, _mm256_max_pd, _mm256_min_pd],
    [_mm256_set1_pd, _mm256_sqrt_pd, _mm256_fmadd_pd, _mm256_fnmadd_pd],
    fn abs(self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
    }
    fn select_positive(of: Self, yes: Self, no: Self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm256_blendv_pd(no.0, yes.0, _mm256_cmp_pd::<_CMP_GT_OQ>(of.0, _mm256_setzero_pd())) })
    }
    fn reduce_add(self) -> f64 {
        // SAFETY: see the type.
        unsafe {
            let half = _mm_add_pd(_mm256_castpd256_pd128(self.0), _mm256_extractf128_pd::<1>(self.0));
            _mm_cvtsd_f64(_mm_add_sd(half, _mm_unpackhi_pd(half, half)))
        }
    }
    fn transpose(rows: &mut [Self]) {
        // SAFETY: see the type.
        unsafe {
            let (a, b) = ((rows[0].0, rows[1].0), (rows[2].0, rows[3].0));
            let a = [_mm256_unpacklo_pd(a.0, a.1), _mm256_unpackhi_pd(a.0, a.1)];
            let b = [_mm256_unpacklo_pd(b.0, b.1), _mm256_unpackhi_pd(b.0, b.1)];
            for i in 0..2 {
                rows[i] = Self(_mm256_permute2f128_pd::<0x20>(a[i], b[i]));
                rows[i + 2] = Self(_mm256_permute2f128_pd::<0x31>(a[i], b[i]));
            }
        }
    }
}

vector! {
    /// Eight numbers in one register. Values of this type only exist in solvers that were constructed after [`has_avx512`]
    /// returned true. Every operation relies on this condition.
    Avx512(__m512d, 8, "avx512f,avx2,fma"),
    [_mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd, _mm512_max_pd, _mm512_min_pd],
    [_mm512_set1_pd, _mm512_sqrt_pd, _mm512_fmadd_pd, _mm512_fnmadd_pd],
    fn abs(self) -> Self {
        // SAFETY: see the type.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    fn select_positive(of: Self, yes: Self, no: Self) -> Self {
        // SAFETY: see the type.
        unsafe {
            let positive = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(of.0, _mm512_setzero_pd());
            Self(_mm512_mask_blend_pd(positive, no.0, yes.0))
        }
    }
    fn reduce_add(self) -> f64 {
        // SAFETY: see the type.
        unsafe {
            let halves = [_mm512_castpd512_pd256(self.0), _mm512_extractf64x4_pd::<1>(self.0)];
            Avx2(_mm256_add_pd(halves[0], halves[1])).reduce_add()
        }
    }
    fn transpose(rows: &mut [Self]) {
        // SAFETY: see the type.
        unsafe {
            // Pairs of numbers of a column, then pairs of pairs, then columns. A closure would not be inlined.
            let mut pairs = [[_mm512_setzero_pd(); 2]; 4];
            for i in 0..4 {
                let (v, w) = (rows[2 * i].0, rows[2 * i + 1].0);
                pairs[i] = [_mm512_unpacklo_pd(v, w), _mm512_unpackhi_pd(v, w)];
            }
            for i in 0..2 {
                let [[a, b], [c, d]] = [[pairs[0][i], pairs[1][i]], [pairs[2][i], pairs[3][i]]];
                let (left, right) = (_mm512_shuffle_f64x2::<0x88>(a, b), _mm512_shuffle_f64x2::<0x88>(c, d));
                rows[i] = Self(_mm512_shuffle_f64x2::<0x88>(left, right));
                rows[i + 4] = Self(_mm512_shuffle_f64x2::<0xdd>(left, right));
                let (left, right) = (_mm512_shuffle_f64x2::<0xdd>(a, b), _mm512_shuffle_f64x2::<0xdd>(c, d));
                rows[i + 2] = Self(_mm512_shuffle_f64x2::<0x88>(left, right));
                rows[i + 6] = Self(_mm512_shuffle_f64x2::<0xdd>(left, right));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{flat, flat_mut};
    use super::*;

    fn transposes<V: Vector>() {
        V::vectorized(
            #[inline(always)]
            || {
                let mut rows = [V::zero(); 8];
                for (i, number) in flat_mut(&mut rows[..V::WIDTH]).iter_mut().enumerate() {
                    *number = i as f64;
                }
                V::transpose(&mut rows);
                for (place, number) in flat(&rows[..V::WIDTH]).iter().enumerate() {
                    assert_eq!(*number, (place % V::WIDTH * V::WIDTH + place / V::WIDTH) as f64);
                }
                let last = rows[V::WIDTH - 1];
                let least = (V::WIDTH - 1) as f64;
                let sum: f64 = (0..V::WIDTH).map(|i| least + (i * V::WIDTH) as f64).sum();
                assert_eq!(last.reduce_add(), sum);
                assert_eq!((-last).abs().reduce_add(), sum);
                assert_eq!(V::select_positive(-last, V::one(), last).reduce_add(), sum);
            },
        );
    }

    #[test]
    fn vectors_are_transposed_and_added() {
        transposes::<super::super::lanes::Portable>();
        if has_avx2() {
            transposes::<Avx2>();
        }
        if has_avx512() {
            transposes::<Avx512>();
        }
    }
}

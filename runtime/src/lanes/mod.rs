//! Computations for several states at once with vector instructions.
//!
//! - [`widest!`](crate::widest) calls generated functions for eight states with the widest vector instructions of
//!   this processor.
//! - [`ZeroOrderHolds`] computes zero-order holds of four robots at a time.

pub(crate) mod batch;
mod hold;
mod packed;
mod product;
#[cfg(feature = "std")]
pub(crate) mod rollout;
#[cfg(test)]
mod tests;

#[cfg(all(target_arch = "x86_64", feature = "std"))]
use crate::qp::lanes::Vector;
#[cfg(all(target_arch = "x86_64", feature = "std"))]
use crate::qp::x86::{Avx2, has_avx2};

pub use hold::{ZeroOrderHolds, instructions};

/// Runs a closure, which should be `#[inline(always)]`, compiled for AVX2 if this processor has it. The compiler does not fuse
/// operations, so that the bits of the results do not depend on the processor.
#[inline(always)]
pub(crate) fn widened<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(all(target_arch = "x86_64", feature = "std"))]
    if has_avx2() {
        return Avx2::vectorized(work);
    }
    work()
}

/// Calls a generated function for eight states, in the fastest version that this processor supports. The three
/// versions are for any processor, for AVX2, and for AVX-512.
///
/// The option `--lanes linearize` generates `linearize_lanes`, and on x86-64 also `linearize_lanes_avx2` and
/// `linearize_lanes_avx512`. The results of the three versions are equal bit for bit. This example linearizes
/// along a horizon, eight points at a time:
///
/// ```
/// use gelenk_generated::powercube::{self as arm, Lanes, M, N};
///
/// // A swing of 0.6 s, held without torque.
/// let horizon: [([f64; N], [f64; N], [f64; M]); 30] = core::array::from_fn(|k| {
///     let t = 0.02 * k as f64;
///     ([0.4 * t.cos(), -0.3 * t.cos()], [-0.4 * t.sin(), 0.3 * t.sin()], [0.0; M])
/// });
/// const ZERO: Lanes = Lanes([0.0; 8]);
/// for points in horizon.chunks(8) {
///     let (mut y, mut v, mut u) = ([ZERO; N], [ZERO; N], [ZERO; M]);
///     for (lane, point) in points.iter().enumerate() {
///         (0..N).for_each(|i| (y[i].0[lane], v[i].0[lane]) = (point.0[i], point.1[i]));
///         (0..M).for_each(|i| u[i].0[lane] = point.2[i]);
///     }
///     let (mut by_y, mut by_v, mut by_u) = ([[ZERO; N]; N], [[ZERO; N]; N], [[ZERO; M]; N]);
///     let mut affine = [ZERO; N];
///     gelenk_runtime::widest!(
///         [arm::linearize_lanes, arm::linearize_lanes_avx2, arm::linearize_lanes_avx512](
///             &y, &v, &u, &mut by_y, &mut by_v, &mut by_u, &mut affine
///         )
///     );
///     for (lane, (y, v, u)) in points.iter().enumerate() {
///         let (single, ..) = arm::linearize(y, v, u);
///         assert_eq!(by_y.map(|row| row.map(|entry| entry.0[lane])), single);
///     }
/// }
/// ```
#[macro_export]
macro_rules! widest {
    ([$any:path, $avx2:path, $avx512:path] ($($argument:expr),* $(,)?)) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if std::is_x86_feature_detected!("avx512f")
                && std::is_x86_feature_detected!("avx512bw")
                && std::is_x86_feature_detected!("avx512dq")
                && std::is_x86_feature_detected!("avx512vl")
            {
                // SAFETY: the processor has the instructions for which this version was compiled.
                unsafe { $avx512($($argument),*) }
            } else if std::is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has AVX2.
                unsafe { $avx2($($argument),*) }
            } else {
                $any($($argument),*)
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            $any($($argument),*)
        }
    }};
}

// Exponential function (after exp_reduced.rs), without branches, tables or fused operations.
//
// The error is below 1 ulp (measured: 0.74), also for subnormal results. The result is ∞ from 709.79 on, 0
// below −745.14, and NaN for NaN.

/// Exponential function `exp x` with an error below 1 ulp.
#[inline(always)]
pub fn exp(x: f64) -> f64 {
    let x = if x > 710.0 { 710.0 } else { x };
    let x = if x < -746.0 { -746.0 } else { x };
    let (hi, low, k) = exp_reduced(x);
    // 2^k is computed as two factors, because k ranges from −1076 to 1024.
    let biased = k.wrapping_add(2048);
    let first = biased >> 1;
    let second = biased.wrapping_sub(first);
    let power = |half: u64| f64::from_bits(half.wrapping_sub(1) << 52);
    (hi + low) * power(first) * power(second)
}

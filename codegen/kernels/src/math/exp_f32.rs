// Exponential function for f32, computed in f32 (after exp_reduced_f32.rs), with the method of exp.rs.
//
// The error is below 1 ulp of f32 (0.79 in a test of all numbers), also for subnormal results. The result is
// ∞ from 88.73 on, 0 below −103.98, and NaN for NaN.

/// Exponential function `exp x` with an error below 1 ulp.
#[inline(always)]
pub fn exp_f32(x: f32) -> f32 {
    let x = if x > 90.0 { 90.0 } else { x };
    let x = if x < -105.0 { -105.0 } else { x };
    let (hi, low, k) = exp_reduced_f32(x);
    // 2^k is computed as two factors, because k ranges from −151 to 130.
    let biased = k.wrapping_add(256);
    let first = biased >> 1;
    let second = biased.wrapping_sub(first);
    let power = |half: u32| f32::from_bits(half.wrapping_sub(1) << 23);
    (hi + low) * power(first) * power(second)
}

// Hyperbolic tangent for f32, computed in f32 (after exp_reduced_f32.rs), with the method of tanh.rs.
//
// For |x| < 0.625 it is x − x³ P(x²)/Q(x²), the fifth convergent of Lambert's continued fraction. For larger
// |x| it is 1 − 2/(exp 2x + 1). Both cases share the division. The error is below 1 ulp of f32 (0.89 in a
// test of all numbers). The result is exactly ±1 from |x| = 9.02 on, tanh −0 is −0, and tanh NaN is NaN.

/// Hyperbolic tangent `tanh x` with an error below 1 ulp. Its derivative is `1 − tanh² x`.
#[inline(always)]
pub fn tanh_f32(x: f32) -> f32 {
    let size = x.abs();
    let z = size * size;
    let small = size < 0.625;
    let p = 315.0 + z * 14.0;
    let q = 945.0 + z * (420.0 + z * 15.0);
    let limited = if size > 10.0 { 10.0 } else { size };
    let (hi, low, k) = exp_reduced_f32(2.0 * limited);
    let power = f32::from_bits(k.wrapping_add(127) << 23);
    let exp = hi + low;
    let sum = exp * power + 1.0;
    // The rounding errors of both additions in `sum`.
    let missing = (1.0 - (sum - exp * power)) + ((hi - exp) + low) * power;
    let quotient = (if small { size * z * p } else { 2.0 }) / if small { q } else { sum };
    let correction = if small {
        0.0
    } else {
        0.5 * quotient * quotient * missing
    };
    let base = if small { size } else { 1.0 };
    let result = base - quotient;
    (result + (((base - result) - quotient) + correction)).copysign(x)
}

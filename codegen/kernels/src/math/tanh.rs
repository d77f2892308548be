// Hyperbolic tangent (after exp_reduced.rs), without branches, tables or fused operations.
//
// For |x| < 0.625 it is x − x³ P(x²)/Q(x²), the eighth convergent of Lambert's continued fraction x/(1 +
// x²/(3 + x²/(5 + …))) (Lambert 1761), whose coefficients are integers. For larger |x| it is 1 − 2/(exp 2x +
// 1). Both cases share the division. The error is below 1 ulp (measured: 0.86). The result is exactly ±1 from
// |x| = 19.07 on, tanh −0 is −0, and tanh NaN is NaN.

/// Hyperbolic tangent `tanh x` with an error below 1 ulp. Its derivative is `1 − tanh² x`.
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let size = x.abs();
    let z = size * size;
    let small = size < 0.625;
    let p = 675675.0 + z * (45045.0 + z * (594.0 + z));
    let q = 2027025.0 + z * (945945.0 + z * (51975.0 + z * (630.0 + z)));
    let limited = if size > 20.0 { 20.0 } else { size };
    let (hi, low, k) = exp_reduced(2.0 * limited);
    let power = f64::from_bits(k.wrapping_add(1023) << 52);
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

// Hyperbolic tangent for f32 (after exp_direct_f32.rs), computed in f64 as in tanh.rs with the fifth convergent of Lambert's
// continued fraction. Error at most 0.52 ulp of f32; ±1 exactly from |x| = 9.02 on; tanh −0 = −0; NaN for NaN.

/// `tanh x` with an error of at most 0.52 ulp. Its derivative is `1 − tanh² x`.
#[inline(always)]
pub fn tanh_f32(x: f32) -> f32 {
    let size = f64::from(x.abs());
    let z = size * size;
    let limited = if size > 20.0 { 20.0 } else { size };
    let exp = exp_direct_f32(2.0 * limited);
    let small = size < 0.625;
    let numerator = if small {
        size * (945.0 + z * (105.0 + z))
    } else {
        exp - 1.0
    };
    let denominator = if small {
        945.0 + z * (420.0 + z * 15.0)
    } else {
        exp + 1.0
    };
    ((numerator / denominator) as f32).copysign(x)
}

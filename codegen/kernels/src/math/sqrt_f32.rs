// Square root for f32 (after sqrt.rs), by way of f64, whose digits are more than twice as many: correctly rounded.

/// `√x`, correctly rounded; NaN for x < 0 and NaN.
#[inline]
pub fn sqrt_f32(x: f32) -> f32 {
    sqrt(f64::from(x)) as f32
}

// Exponential function for f32 (after exp_direct_f32.rs). Error at most 0.51 ulp of f32, in the subnormal range too;
// ∞ from 88.73 on, 0 below −103.98, NaN for NaN.

/// `exp x` with an error of at most 0.51 ulp.
#[inline(always)]
pub fn exp_f32(x: f32) -> f32 {
    let x = if x > 90.0 { 90.0 } else { x };
    let x = if x < -110.0 { -110.0 } else { x };
    exp_direct_f32(f64::from(x)) as f32
}

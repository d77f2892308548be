// Sine and cosine for f32 (after sin_cos.rs), computed in f64 with shorter polynomials: a reduction in f32 alone loses
// the angle near multiples of π/2, and f32 polynomials after one in f64 miss 1 ulp and are no faster in lanes.
// Error at most 0.51 ulp of f32 for every finite x; NaN for NaN and ±∞; sin −0 = −0.

/// `(sin x, cos x)` with an error of at most 0.51 ulp each.
#[inline(always)]
pub fn sin_cos_f32(x: f32) -> (f32, f32) {
    if x.abs() <= 1.0e5 {
        sin_cos_direct_f32(x)
    } else {
        sin_cos_large_f32(x)
    }
}

#[cold]
#[inline(never)]
fn sin_cos_large_f32(x: f32) -> (f32, f32) {
    let (sin, cos) = sin_cos(f64::from(x));
    (sin as f32, cos as f32)
}

/// `|x| ≤ 1e5`: `n π/2` is exact in the first part, and 86 bits of π/2 suffice for the f32 closest to a multiple.
#[inline(always)]
fn sin_cos_direct_f32(x: f32) -> (f32, f32) {
    const HALF_PI: [f64; 2] = [1.5707963267341256, 6.077100506506192e-11];
    const TWO_OVER_PI: f64 = core::f64::consts::FRAC_2_PI;
    const TO_INTEGER: f64 = 6755399441055744.0; // 1.5 · 2^52: the sum's last bits are the nearest integer
    let shifted = f64::from(x) * TWO_OVER_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let r = (f64::from(x) - n * HALF_PI[0]) - n * HALF_PI[1];
    let z = r * r;
    let z2 = z * z;
    let p = (0.16666666641627026 + z * -0.00833332938594328)
        + z2 * (0.00019839334851758369 + z * -2.718311630651964e-6);
    let q = (0.041666646866486835 + z * -0.0013887367517165202) + z2 * 2.443845165061258e-5;
    let (sin, cos) = in_quadrant(
        r * (1.0 - z * p),
        1.0 - (0.5 * z - z2 * q),
        shifted.to_bits(),
    );
    (sin as f32, cos as f32)
}

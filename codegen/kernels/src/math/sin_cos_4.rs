// Sine and cosine of 4 angles that arrive in registers (after sin_cos_array.rs).
// Never inlined: among scalar code the compiler would undo the lanes.

/// Sines and cosines of 4 angles, the same bits as [`sin_cos`] of each.
#[inline(never)]
pub fn sin_cos_4(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    sin_cos_array([a, b, c, d])
}

// Sine and cosine of 2 angles that arrive in registers (after sin_cos_array.rs).
// Never inlined: among scalar code the compiler would undo the lanes.

/// Sines and cosines of 2 angles, the same bits as [`sin_cos`] of each.
#[inline(never)]
pub fn sin_cos_2(a: f64, b: f64) -> ([f64; 2], [f64; 2]) {
    sin_cos_array([a, b])
}

// Sine and cosine of 4 angles that are passed in registers (after sin_cos_array.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 4 angles, bit-identical to [`sin_cos`] of each angle.
#[inline(never)]
pub fn sin_cos_4(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    sin_cos_array([a, b, c, d])
}

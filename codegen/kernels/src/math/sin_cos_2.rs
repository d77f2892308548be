// Sine and cosine of 2 angles that are passed in registers (after sin_cos_array.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 2 angles, bit-identical to [`sin_cos`] of each angle.
#[inline(never)]
pub fn sin_cos_2(a: f64, b: f64) -> ([f64; 2], [f64; 2]) {
    sin_cos_array([a, b])
}

// Sine and cosine of 4 angles that are passed in registers (after sin_cos_array_f32.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 4 angles, bit-identical to [`sin_cos_f32`] of each angle.
#[inline(never)]
pub fn sin_cos_4_f32(a: f32, b: f32, c: f32, d: f32) -> ([f32; 4], [f32; 4]) {
    sin_cos_array_f32([a, b, c, d])
}

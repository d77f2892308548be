// Sine and cosine of 2 angles that are passed in registers (after sin_cos_array_f32.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 2 angles, bit-identical to [`sin_cos_f32`] of each angle.
#[inline(never)]
pub fn sin_cos_2_f32(a: f32, b: f32) -> ([f32; 2], [f32; 2]) {
    sin_cos_array_f32([a, b])
}

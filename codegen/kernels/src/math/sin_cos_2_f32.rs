// Sine and cosine of 2 angles that arrive in registers (after sin_cos_array_f32.rs).
// Never inlined: among scalar code the compiler would undo the lanes.

/// Sines and cosines of 2 angles, the same bits as [`sin_cos_f32`] of each.
#[inline(never)]
pub fn sin_cos_2_f32(a: f32, b: f32) -> ([f32; 2], [f32; 2]) {
    sin_cos_array_f32([a, b])
}

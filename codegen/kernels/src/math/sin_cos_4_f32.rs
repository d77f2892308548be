// Sine and cosine of 4 angles that arrive in registers (after sin_cos_array_f32.rs).
// Never inlined: among scalar code the compiler would undo the lanes.

/// Sines and cosines of 4 angles, the same bits as [`sin_cos_f32`] of each.
#[inline(never)]
pub fn sin_cos_4_f32(a: f32, b: f32, c: f32, d: f32) -> ([f32; 4], [f32; 4]) {
    sin_cos_array_f32([a, b, c, d])
}

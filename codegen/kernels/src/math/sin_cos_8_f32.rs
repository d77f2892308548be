// Sine and cosine of 8 angles that are passed in registers (after sin_cos_array_f32.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 8 angles, bit-identical to [`sin_cos_f32`] of each angle.
#[allow(
    clippy::too_many_arguments,
    reason = "an array would pass through memory"
)]
#[inline(never)]
pub fn sin_cos_8_f32(
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    e: f32,
    f: f32,
    g: f32,
    h: f32,
) -> ([f32; 8], [f32; 8]) {
    let (sin, cos) = sin_cos_array_f32([a, b, c, d]);
    let (more_sin, more_cos) = sin_cos_array_f32([e, f, g, h]);
    let joined = |x: [f32; 4], y: [f32; 4]| [x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3]];
    (joined(sin, more_sin), joined(cos, more_cos))
}

// Sine and cosine of 8 angles that are passed in registers (after sin_cos_array.rs). The function is not
// inlined, because the compiler would undo the vectorization in scalar code.

/// Sines and cosines of 8 angles, bit-identical to [`sin_cos`] of each angle.
#[allow(
    clippy::too_many_arguments,
    reason = "an array would pass through memory"
)]
#[inline(never)]
pub fn sin_cos_8(
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    e: f64,
    f: f64,
    g: f64,
    h: f64,
) -> ([f64; 8], [f64; 8]) {
    let (sin, cos) = sin_cos_array([a, b, c, d]);
    let (more_sin, more_cos) = sin_cos_array([e, f, g, h]);
    let joined = |x: [f64; 4], y: [f64; 4]| [x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3]];
    (joined(sin, more_sin), joined(cos, more_cos))
}

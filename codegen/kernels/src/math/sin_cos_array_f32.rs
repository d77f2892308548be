// Sine and cosine of several angles at once for f32 (after sin_cos_f32.rs). The loop has no branch, so it
// becomes SIMD code.

/// Returns all `sin xᵢ`, then all `cos xᵢ`, bit-identical to [`sin_cos_f32`] of each angle.
#[inline(always)]
pub fn sin_cos_array_f32<const L: usize>(x: [f32; L]) -> ([f32; L], [f32; L]) {
    let (mut sin, mut cos, mut all_direct) = ([0.0; L], [0.0; L], true);
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos_direct_f32(x[i]);
        all_direct &= x[i].abs() <= LARGEST_DIRECT_ANGLE_F32;
    }
    if all_direct {
        (sin, cos)
    } else {
        sin_cos_array_large_f32(x)
    }
}

#[cold]
#[inline(never)]
fn sin_cos_array_large_f32<const L: usize>(x: [f32; L]) -> ([f32; L], [f32; L]) {
    let pairs = x.map(sin_cos_f32);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}

// Sine and cosine of several angles at once (after sin_cos.rs). The loop has no branch, so it becomes SIMD
// code.

/// Returns all `sin xᵢ`, then all `cos xᵢ`, bit-identical to [`sin_cos`] of each angle.
#[inline(always)]
pub fn sin_cos_array<const L: usize>(x: [f64; L]) -> ([f64; L], [f64; L]) {
    let (mut sin, mut cos, mut all_direct) = ([0.0; L], [0.0; L], true);
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos_direct(x[i]);
        all_direct &= x[i].abs() <= LARGEST_DIRECT_ANGLE;
    }
    if all_direct {
        (sin, cos)
    } else {
        sin_cos_array_large(x)
    }
}

#[cold]
#[inline(never)]
fn sin_cos_array_large<const L: usize>(x: [f64; L]) -> ([f64; L], [f64; L]) {
    let pairs = x.map(sin_cos);
    (pairs.map(|pair| pair.0), pairs.map(|pair| pair.1))
}

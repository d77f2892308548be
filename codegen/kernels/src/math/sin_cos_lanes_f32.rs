// Sine and cosine of the angles of several states for f32, written in place (after sin_cos_f32.rs).

/// Writes the sine and cosine of each angle, bit-identical to [`sin_cos_f32`] of this angle.
#[inline(always)]
pub fn sin_cos_lanes_f32<const L: usize>(x: &[f32; L], sin: &mut [f32; L], cos: &mut [f32; L]) {
    let mut all_direct = true;
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos_direct_f32(x[i]);
        all_direct &= x[i].abs() <= LARGEST_DIRECT_ANGLE_F32;
    }
    if !all_direct {
        sin_cos_lanes_large_f32(x, sin, cos);
    }
}

#[cold]
#[inline(never)]
fn sin_cos_lanes_large_f32<const L: usize>(x: &[f32; L], sin: &mut [f32; L], cos: &mut [f32; L]) {
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos_f32(x[i]);
    }
}

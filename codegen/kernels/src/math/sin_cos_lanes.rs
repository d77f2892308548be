// Sine and cosine of the angles of several states, written in place (after sin_cos.rs). Results that are
// returned by value would be copied twice.

/// Writes the sine and cosine of each angle, bit-identical to [`sin_cos`] of this angle.
#[inline(always)]
pub fn sin_cos_lanes<const L: usize>(x: &[f64; L], sin: &mut [f64; L], cos: &mut [f64; L]) {
    let mut all_direct = true;
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos_direct(x[i]);
        all_direct &= x[i].abs() <= LARGEST_DIRECT_ANGLE;
    }
    if !all_direct {
        sin_cos_lanes_large(x, sin, cos);
    }
}

#[cold]
#[inline(never)]
fn sin_cos_lanes_large<const L: usize>(x: &[f64; L], sin: &mut [f64; L], cos: &mut [f64; L]) {
    for i in 0..L {
        (sin[i], cos[i]) = sin_cos(x[i]);
    }
}

// What exp_f32.rs and tanh_f32.rs share, in f64 with a short minimax polynomial (Remez exchange, minimax.py).

/// `exp x` for `|x| ≤ 110`, relative error below 2^−32.
#[inline(always)]
fn exp_direct_f32(x: f64) -> f64 {
    const TO_INTEGER: f64 = 6755399441055744.0; // 1.5 · 2^52: the sum's last bits are the nearest integer
    let shifted = x * core::f64::consts::LOG2_E + TO_INTEGER;
    let r = x - (shifted - TO_INTEGER) * core::f64::consts::LN_2;
    let r2 = r * r;
    let p = (0.500000004303789 + r * 0.16666666822963463)
        + r2 * ((0.04166635736369276 + r * 0.008333271724051775)
            + r2 * (0.0013941060088417158 + r * 0.00019914865185100252));
    let power = f64::from_bits(
        shifted
            .to_bits()
            .wrapping_sub(TO_INTEGER.to_bits())
            .wrapping_add(1023)
            << 52,
    );
    (1.0 + (r + r2 * p)) * power
}

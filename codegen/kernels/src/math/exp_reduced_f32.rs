// Common part of exp_f32.rs and tanh_f32.rs, in f32 (after exp_reduced.rs). The argument is reduced to x = k
// ln 2 + r with |r| ≤ ln 2 / 2 and ln 2 in two parts. A minimax polynomial follows (minimax.py).

/// Returns hi, low and k with `exp x = (hi + low) 2^k` and `|low| < 0.08`. A negative `k` is in two's
/// complement.
#[inline(always)]
fn exp_reduced_f32(x: f32) -> (f32, f32, u32) {
    const LN_2: [f32; 2] = [0.69314575, 1.4286068e-6];
    const LOG2_E: f32 = core::f32::consts::LOG2_E;
    const TO_INTEGER: f32 = 12582912.0; // 1.5 · 2^23: the sum's last bits are the nearest integer
    let shifted = x * LOG2_E + TO_INTEGER;
    let k = shifted - TO_INTEGER;
    let hi = x - k * LN_2[0];
    let low = k * LN_2[1];
    let r = hi - low;
    let r2 = r * r;
    let p = (0.5 + r * 0.16666532) + r2 * ((0.041666258 + r * 0.008367701) + r2 * 0.0013947901);
    let sum = 1.0 + hi;
    (
        sum,
        ((1.0 - sum) + hi) + (r2 * p - low),
        shifted.to_bits().wrapping_sub(TO_INTEGER.to_bits()),
    )
}

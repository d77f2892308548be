// Common part of exp.rs and tanh.rs. The argument is reduced to x = k ln 2 + r with |r| ≤ ln 2 / 2 and ln 2
// in two parts (Cody and Waite, Software Manual for the Elementary Functions, 1980, ch. 6). A minimax
// polynomial follows (Remez exchange, minimax.py).

/// Returns hi, low and k with `exp x = (hi + low) 2^k` and `|low| < 0.08`. A negative `k` is in two's
/// complement.
#[inline(always)]
fn exp_reduced(x: f64) -> (f64, f64, u64) {
    const LN_2: [f64; 2] = [0.6931471805598903, 5.497923018708371e-14];
    const LOG2_E: f64 = core::f64::consts::LOG2_E;
    const TO_INTEGER: f64 = 6755399441055744.0; // 1.5 · 2^52: the sum's last bits are the nearest integer
    let shifted = x * LOG2_E + TO_INTEGER;
    let k = shifted - TO_INTEGER;
    let hi = x - k * LN_2[0];
    let low = k * LN_2[1];
    let r = hi - low;
    let r2 = r * r;
    let r4 = r2 * r2;
    let p = (0.5000000000000003 + r * 0.16666666666666685)
        + r2 * (0.041666666666586645 + r * 0.008333333333315226)
        + r4 * ((0.001388888892985391 + r * 0.00019841269902211344)
            + r2 * (2.480150641915018e-5 + r * 2.7557228365358775e-6)
            + r4 * (2.762578738025877e-7 + r * 2.511441141799656e-8));
    let sum = 1.0 + hi;
    (
        sum,
        ((1.0 - sum) + hi) + (r2 * p - low),
        shifted.to_bits().wrapping_sub(TO_INTEGER.to_bits()),
    )
}

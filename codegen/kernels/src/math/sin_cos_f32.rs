// Sine and cosine for f32, computed in f32 (after sin_cos.rs), without branches up to 400, tables or fused
// operations.
//
// The angle is reduced to x = n π/2 + hi − low with |hi| ≤ π/4. Up to 400, π/2 is used in three parts (Cody
// and Waite). Above 400, the bits of 2/π are used (Payne and Hanek), in integers of 32 and 64 bits. Minimax
// polynomials follow (Remez exchange, minimax.py). The error is below 0.9 ulp of f32 for every finite x (0.84
// in a test of all numbers). The results are NaN for NaN and ±∞, and sin −0 is −0.

/// Largest angle of the fast path, with n ≤ 255. Up to this angle, `n π/2` is exact in the first two parts.
const LARGEST_DIRECT_ANGLE_F32: f32 = 400.0;

/// Returns `(sin x, cos x)`, each with an error below 0.9 ulp.
#[inline(always)]
pub fn sin_cos_f32(x: f32) -> (f32, f32) {
    if x.abs() <= LARGEST_DIRECT_ANGLE_F32 {
        sin_cos_direct_f32(x)
    } else {
        sin_cos_large_f32(x)
    }
}

/// Sine and cosine for `|x| ≤ 400`. The first difference is exact. The rounding error of the second
/// difference is kept (Fast2Sum).
#[inline(always)]
fn sin_cos_direct_f32(x: f32) -> (f32, f32) {
    const HALF_PI: [f32; 3] = [1.5707703, 2.6063062e-5, 6.0771006e-11];
    const TWO_OVER_PI: f32 = core::f32::consts::FRAC_2_PI;
    const TO_INTEGER: f32 = 12582912.0; // 1.5 · 2^23: the sum's last bits are the nearest integer
    let shifted = x * TWO_OVER_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let first = x - n * HALF_PI[0];
    let second = n * HALF_PI[1];
    let hi = first - second;
    let low = n * HALF_PI[2] - ((first - hi) - second);
    sin_cos_quarter_f32(hi, low, shifted.to_bits())
}

/// Sine and cosine of `hi − low + quadrant π/2` with `|hi| ≤ π/4`. `low` has the size of a rounding error of
/// `hi`.
#[inline(always)]
fn sin_cos_quarter_f32(hi: f32, low: f32, quadrant: u32) -> (f32, f32) {
    let z = hi * hi;
    let p = 0.16666655 + z * (-0.008332192 + z * 0.00019518787);
    let q = 0.041666646 + z * (-0.0013887301 + z * 2.443067e-5);
    let half = 0.5 * z;
    let w = 1.0 - half;
    let sin = hi - (hi * z * p + low * w);
    let cos = w + (((1.0 - w) - half) + (z * z * q + hi * low));
    // Only the last two bits of the quadrant are used.
    let exchange = (sin.to_bits() ^ cos.to_bits()) & (quadrant & 1).wrapping_neg();
    let sin_sign = (quadrant & 2) << 30;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 30;
    (
        f32::from_bits(sin.to_bits() ^ exchange ^ sin_sign),
        f32::from_bits(cos.to_bits() ^ exchange ^ cos_sign),
    )
}

/// Sine and cosine for `|x| > 400` or NaN. `x · 2/π` modulo 4 is computed in integers from the 96 relevant
/// bits of 2/π.
#[cold]
#[inline(never)]
fn sin_cos_large_f32(x: f32) -> (f32, f32) {
    // A zero word, then the first 224 bits of 2/π.
    const TWO_OVER_PI: [u32; 8] = [
        0x00000000, 0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041,
        0xfe5163ab,
    ];
    const HALF_PI: u64 = 0xc90fdaa2; // times 2^-31
    if !x.is_finite() {
        return (f32::NAN, f32::NAN);
    }
    // |x| = mantissa · 2^(start − 30). The bits of 2/π before `start` only add multiples of 4.
    let start = (x.abs().to_bits() >> 23).wrapping_sub(120);
    let mantissa = u64::from(x.to_bits() & 0x007F_FFFF | 0x0080_0000);
    let word = |k: u32| {
        u64::from(
            TWO_OVER_PI
                .get((start / 32 + k) as usize)
                .copied()
                .unwrap_or(0),
        )
    };
    let product = |k: u32| mantissa * ((word(k) << 32 | word(k + 1)) << (start % 32) >> 32);
    // x · 2/π = (turns modulo 4) / 2^62. The first two bits are the quadrant. The other bits are a fraction,
    // which is shifted to [−1/2, 1/2).
    let turns = (product(0) << 32).wrapping_add(product(1) + (product(2) >> 32));
    let quadrant = ((turns >> 62) + (turns >> 61 & 1)) as u32;
    let fraction = (turns << 2).cast_signed();
    let zeros = fraction.unsigned_abs().leading_zeros();
    let angle = (fraction.unsigned_abs().wrapping_shl(zeros) >> 32) * HALF_PI; // times 2^(−63 − zeros)
    let sign = if fraction < 0 { 1 << 31 } else { 0 };
    let scale = |power: u32| f32::from_bits(power.wrapping_sub(zeros) << 23 | sign);
    let hi = (angle >> 40) as u32 as f32 * scale(104);
    let low = ((angle >> 16) as u32 & 0x00FF_FFFF) as f32 * -scale(80);
    let (sin, cos) = sin_cos_quarter_f32(hi, low, quadrant);
    (if x < 0.0 { -sin } else { sin }, cos)
}

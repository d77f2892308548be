// Sine and cosine in one pass, without branches up to 1e5, tables or fused operations. Bits are reproducible.
//
// The angle is reduced to x = n π/2 + hi − low with |hi| ≤ π/4. Up to 1e5, π/2 is used in three parts (Cody
// and Waite, Software Manual for the Elementary Functions, 1980, ch. 8). Above 1e5, the bits of 2/π are used
// (Payne and Hanek, SIGNUM Newsletter 18, 1983). Minimax polynomials follow (Remez exchange, minimax.py). The
// error is below 0.9 ulp for every finite x (measured: 0.80). NaN and ±∞ give NaN, and sin −0 is −0.

/// Largest angle of the fast path. Up to this angle, `n π/2` is exact in the first two parts.
const LARGEST_DIRECT_ANGLE: f64 = 1.0e5;

/// Returns `(sin x, cos x)`, each with an error below 0.9 ulp.
#[inline(always)]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= LARGEST_DIRECT_ANGLE {
        sin_cos_direct(x)
    } else {
        sin_cos_large(x)
    }
}

/// Sine and cosine for `|x| ≤ 1e5`. The first difference is exact. Fast2Sum keeps the error of the second.
#[inline(always)]
fn sin_cos_direct(x: f64) -> (f64, f64) {
    const HALF_PI: [f64; 3] = [
        1.5707963267923333,
        2.5633441515839558e-12,
        1.0562999066987428e-23,
    ];
    const TWO_OVER_PI: f64 = core::f64::consts::FRAC_2_PI;
    const TO_INTEGER: f64 = 6755399441055744.0; // 1.5 · 2^52: the sum's last bits are the nearest integer
    let shifted = x * TWO_OVER_PI + TO_INTEGER;
    let n = shifted - TO_INTEGER;
    let first = x - n * HALF_PI[0];
    let second = n * HALF_PI[1];
    let hi = first - second;
    let low = n * HALF_PI[2] - ((first - hi) - second);
    sin_cos_quarter(hi, low, shifted.to_bits())
}

/// Sine and cosine of `hi − low + quadrant π/2` with `|hi| ≤ π/4`. `low` is a rounding error of `hi`.
#[inline(always)]
fn sin_cos_quarter(hi: f64, low: f64, quadrant: u64) -> (f64, f64) {
    let z = hi * hi;
    let z2 = z * z;
    let z4 = z2 * z2;
    let p = (0.16666666666666632 + z * -0.00833333333332249)
        + (z2 * (0.00019841269829857792 + z * -2.7557313706995275e-6)
            + z4 * (2.5050760238992093e-8 + z * -1.5896908978047454e-10));
    let q = (0.0416666666666666 + z * -0.0013888888888874474)
        + (z2 * (2.4801587289671523e-5 + z * -2.755731440102192e-7)
            + z4 * (2.08757292794275e-9 + z * -1.1359934120766979e-11));
    let half = 0.5 * z;
    let w = 1.0 - half;
    let sin = hi - (hi * z * p + low * w);
    let cos = w + (((1.0 - w) - half) + (z2 * q + hi * low));
    in_quadrant(sin, cos, quadrant)
}

/// Sine and cosine of an angle after a rotation by `quadrant` quarter turns, from the sine and cosine of the
/// angle. Only the last two bits of `quadrant` are used.
#[inline(always)]
fn in_quadrant(sin: f64, cos: f64, quadrant: u64) -> (f64, f64) {
    let exchange = (sin.to_bits() ^ cos.to_bits()) & (quadrant & 1).wrapping_neg();
    let sin_sign = (quadrant & 2) << 62;
    let cos_sign = (quadrant.wrapping_add(1) & 2) << 62;
    (
        f64::from_bits(sin.to_bits() ^ exchange ^ sin_sign),
        f64::from_bits(cos.to_bits() ^ exchange ^ cos_sign),
    )
}

/// Sine and cosine for `|x| > 1e5` or NaN. `x · 2/π` modulo 4 is computed in integers from bits of 2/π.
#[cold]
#[inline(never)]
fn sin_cos_large(x: f64) -> (f64, f64) {
    // A zero word, then the first 1216 bits of 2/π.
    const TWO_OVER_PI: [u64; 20] = [
        0x0000000000000000,
        0xa2f9836e4e441529,
        0xfc2757d1f534ddc0,
        0xdb6295993c439041,
        0xfe5163abdebbc561,
        0xb7246e3a424dd2e0,
        0x06492eea09d1921c,
        0xfe1deb1cb129a73e,
        0xe88235f52ebb4484,
        0xe99c7026b45f7e41,
        0x3991d639835339f4,
        0x9c845f8bbdf9283b,
        0x1ff897ffde05980f,
        0xef2f118b5a0a6d1f,
        0x6d367ecf27cb09b7,
        0x4f463f669e5fea2d,
        0x7527bac7ebe5f17b,
        0x3d0739f78a5292ea,
        0x6bfb5fb11f8d5d08,
        0x56033046fc7b6bab,
    ];
    const HALF_PI: u128 = 0xc90fdaa22168c235; // times 2^-63
    if !x.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    // |x| = mantissa · 2^exponent. The bits of 2/π before `start` only add multiples of 4.
    let exponent = (x.abs().to_bits() >> 52).wrapping_sub(1075);
    let mantissa = u128::from(x.to_bits() & ((1 << 52) - 1) | 1 << 52);
    let start = exponent.wrapping_add(62);
    let word = |k: u64| {
        TWO_OVER_PI
            .get((start / 64 + k) as usize)
            .copied()
            .unwrap_or(0)
    };
    let bits = |k: u64| (u128::from(word(k)) << 64 | u128::from(word(k + 1))) << (start % 64) >> 64;
    let low = mantissa * bits(2);
    let middle = mantissa * bits(1) + (low >> 64);
    let high = mantissa.wrapping_mul(bits(0)).wrapping_add(middle >> 64);
    // x · 2/π = (turns modulo 4) / 2^126. Two bits are the quadrant. The others are a fraction in [−1/2, 1/2).
    let turns = high << 64 | middle & u128::from(u64::MAX);
    let quadrant = ((turns >> 126) + (turns >> 125 & 1)) as u64;
    let fraction = (turns << 2) as i128;
    let zeros = fraction.unsigned_abs().leading_zeros();
    let angle = (fraction.unsigned_abs().wrapping_shl(zeros) >> 64) * HALF_PI;
    let scale = f64::from_bits(u64::from(896 - zeros) << 52); // 2^(−127 − zeros)
    let hi = angle as f64;
    let low = (hi as u128).wrapping_sub(angle) as i128 as f64;
    let sign = if fraction < 0 { -scale } else { scale };
    let (sin, cos) = sin_cos_quarter(hi * sign, low * sign, quadrant);
    (if x < 0.0 { -sin } else { sin }, cos)
}

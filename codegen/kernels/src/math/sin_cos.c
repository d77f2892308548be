// Sine and cosine in one pass, without branches up to 1e5, tables or fused operations. Results have the same
// bits on every platform.
//
// The angle is reduced to x = n pi/2 + hi - low with |hi| <= pi/4. Up to 1e5, pi/2 is used in three parts
// (Cody and Waite, Software Manual for the Elementary Functions, 1980, ch. 8). Above 1e5, the bits of 2/pi
// are used (Payne and Hanek, SIGNUM Newsletter 18, 1983). Minimax polynomials follow (Remez exchange). The
// error is below 0.9 ulp for every finite x (measured: 0.80). The results are NaN for NaN and infinities, and
// sin -0 is -0.

// Largest angle of the fast path. Up to this angle, n pi/2 is exact in the first two parts.
#define GELENK_LARGEST_DIRECT_ANGLE 1.0e5

// Sine and cosine of an angle after a rotation by `quadrant` quarter turns, from the sine and cosine of the
// angle. Only the last two bits of `quadrant` are used.
GELENK_INLINE void gelenk_in_quadrant(double sine, double cosine, uint64_t quadrant, double *sin_x, double *cos_x)
{
    const uint64_t sine_bits = gelenk_bits(sine);
    const uint64_t cosine_bits = gelenk_bits(cosine);
    const uint64_t exchange = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
    *sin_x = gelenk_from_bits(sine_bits ^ exchange ^ ((quadrant & 2) << 62));
    *cos_x = gelenk_from_bits(cosine_bits ^ exchange ^ (((quadrant + 1) & 2) << 62));
}

// Sine and cosine of hi - low + quadrant pi/2 with |hi| <= pi/4. low has the size of a rounding error of hi.
GELENK_INLINE void gelenk_sin_cos_quarter(double hi, double low, uint64_t quadrant, double *sin_x, double *cos_x)
{
    const double z = hi * hi;
    const double z2 = z * z;
    const double z4 = z2 * z2;
    const double p = (0.16666666666666632 + z * -0.00833333333332249)
        + (z2 * (0.00019841269829857792 + z * -2.7557313706995275e-6)
           + z4 * (2.5050760238992093e-8 + z * -1.5896908978047454e-10));
    const double q = (0.0416666666666666 + z * -0.0013888888888874474)
        + (z2 * (2.4801587289671523e-5 + z * -2.755731440102192e-7)
           + z4 * (2.08757292794275e-9 + z * -1.1359934120766979e-11));
    const double half = 0.5 * z;
    const double w = 1.0 - half;
    const double sine = hi - (hi * z * p + low * w);
    const double cosine = w + (((1.0 - w) - half) + (z2 * q + hi * low));
    gelenk_in_quadrant(sine, cosine, quadrant, sin_x, cos_x);
}

// Sine and cosine for |x| <= 1e5. The first difference is exact. The rounding error of the second difference
// is kept (Fast2Sum).
GELENK_INLINE void gelenk_sin_cos_direct(double x, double *sin_x, double *cos_x)
{
    const double two_over_pi = 0.6366197723675814;
    const double to_integer = 6755399441055744.0; // 1.5 * 2^52: the sum's last bits are the nearest integer
    const double shifted = x * two_over_pi + to_integer;
    const double n = shifted - to_integer;
    const double first = x - n * 1.5707963267923333;
    const double second = n * 2.5633441515839558e-12;
    const double hi = first - second;
    const double low = n * 1.0562999066987428e-23 - ((first - hi) - second);
    gelenk_sin_cos_quarter(hi, low, gelenk_bits(shifted), sin_x, cos_x);
}

// The 128 bits of the product a b. The upper half is written to `high`.
static uint64_t gelenk_product(uint64_t a, uint64_t b, uint64_t *high)
{
    const uint64_t low_mask = 0xffffffffu;
    const uint64_t ll = (a & low_mask) * (b & low_mask);
    const uint64_t lh = (a & low_mask) * (b >> 32);
    const uint64_t hl = (a >> 32) * (b & low_mask);
    const uint64_t middle = (ll >> 32) + (lh & low_mask) + (hl & low_mask);
    *high = (a >> 32) * (b >> 32) + (lh >> 32) + (hl >> 32) + (middle >> 32);
    return (middle << 32) | (ll & low_mask);
}

// Sine and cosine for |x| > 1e5 or NaN. x 2/pi modulo 4 is computed in integers from the relevant bits of
// 2/pi.
GELENK_NOINLINE static void gelenk_sin_cos_large(double x, double *sin_x, double *cos_x)
{
    // A zero word, then the first 1216 bits of 2/pi.
    static const uint64_t two_over_pi[20] = {
        UINT64_C(0x0000000000000000), UINT64_C(0xa2f9836e4e441529), UINT64_C(0xfc2757d1f534ddc0),
        UINT64_C(0xdb6295993c439041), UINT64_C(0xfe5163abdebbc561), UINT64_C(0xb7246e3a424dd2e0),
        UINT64_C(0x06492eea09d1921c), UINT64_C(0xfe1deb1cb129a73e), UINT64_C(0xe88235f52ebb4484),
        UINT64_C(0xe99c7026b45f7e41), UINT64_C(0x3991d639835339f4), UINT64_C(0x9c845f8bbdf9283b),
        UINT64_C(0x1ff897ffde05980f), UINT64_C(0xef2f118b5a0a6d1f), UINT64_C(0x6d367ecf27cb09b7),
        UINT64_C(0x4f463f669e5fea2d), UINT64_C(0x7527bac7ebe5f17b), UINT64_C(0x3d0739f78a5292ea),
        UINT64_C(0x6bfb5fb11f8d5d08), UINT64_C(0x56033046fc7b6bab),
    };
    const uint64_t half_pi = UINT64_C(0xc90fdaa22168c235); // times 2^-63
    const uint64_t size = gelenk_bits(x) & (UINT64_MAX >> 1);
    if (size >= UINT64_C(0x7ff) << 52) {
        *sin_x = *cos_x = x - x;
        return;
    }
    // |x| = mantissa 2^exponent. The bits of 2/pi before `start` only add multiples of 4.
    const uint64_t mantissa = (size & ((UINT64_C(1) << 52) - 1)) | UINT64_C(1) << 52;
    const unsigned start = (unsigned)((size >> 52) - 1075 + 62);
    const unsigned shift = start % 64;
    uint64_t bits[3];
    for (unsigned k = 0; k < 3; ++k) {
        const uint64_t word = two_over_pi[start / 64 + k];
        const uint64_t next = two_over_pi[start / 64 + k + 1];
        bits[k] = shift == 0 ? word : word << shift | next >> (64 - shift);
    }
    // x 2/pi = (turns modulo 4) / 2^126. The first two bits are the quadrant. The other bits are a fraction,
    // which is shifted to [-1/2, 1/2).
    uint64_t carry, middle_high;
    gelenk_product(mantissa, bits[2], &carry);
    const uint64_t product = gelenk_product(mantissa, bits[1], &middle_high);
    const uint64_t turns_low = product + carry;
    const uint64_t turns_high = mantissa * bits[0] + middle_high + (turns_low < product);
    const uint64_t quadrant = (turns_high >> 62) + (turns_high >> 61 & 1);
    uint64_t high = turns_high << 2 | turns_low >> 62;
    uint64_t low = turns_low << 2;
    const int is_negative = high >> 63 != 0;
    if (is_negative) {
        low = 0 - low;
        high = ~high + (low == 0);
    }
    uint64_t zeros = 0;
    while (high >> 63 == 0 && zeros < 128) {
        high = high << 1 | low >> 63;
        low <<= 1;
        ++zeros;
    }
    // The angle times a power of two, rounded to double. The last bit is also set if any lower bit is set.
    uint64_t angle_high;
    const uint64_t angle_low = gelenk_product(high, half_pi, &angle_high);
    const double two_64 = 18446744073709551616.0;
    const double hi = (double)(angle_high | (angle_low != 0)) * two_64;
    // The rounding error of hi, which is a multiple of 2^64.
    uint64_t rest_low = 0 - angle_low;
    uint64_t rest_high = (uint64_t)(hi / two_64) - angle_high - (angle_low != 0);
    const int is_rest_negative = rest_high >> 63 != 0;
    if (is_rest_negative) {
        rest_low = 0 - rest_low;
        rest_high = ~rest_high + (rest_low == 0);
    }
    double rest_scale = 1.0;
    while (rest_high != 0) { // at most 11 times
        rest_low = rest_low >> 1 | rest_high << 63 | (rest_low & 1);
        rest_high >>= 1;
        rest_scale *= 2.0;
    }
    const double rest = (double)rest_low * rest_scale;
    const double scale = gelenk_from_bits((896 - zeros) << 52); // 2^(-127 - zeros)
    const double sign = is_negative ? -scale : scale;
    gelenk_sin_cos_quarter(hi * sign, (is_rest_negative ? -rest : rest) * sign, quadrant, sin_x, cos_x);
    *sin_x = x < 0.0 ? -*sin_x : *sin_x;
}

// Sine and cosine of x, each with an error below 0.9 ulp.
GELENK_INLINE void gelenk_sin_cos(double x, double *sin_x, double *cos_x)
{
    if (x >= -GELENK_LARGEST_DIRECT_ANGLE && x <= GELENK_LARGEST_DIRECT_ANGLE) {
        gelenk_sin_cos_direct(x, sin_x, cos_x);
    } else {
        gelenk_sin_cos_large(x, sin_x, cos_x);
    }
}

// Sine and cosine for float, computed in float, without branches up to 400, tables or fused operations.
//
// The angle is reduced to x = n pi/2 + hi - low with |hi| <= pi/4. Up to 400, pi/2 is used in three parts
// (Cody and Waite). Above 400, the bits of 2/pi are used (Payne and Hanek), in integers of 32 and 64 bits.
// Minimax polynomials follow (Remez exchange). The error is below 0.9 ulp of float for every finite x (0.84
// in a test of all numbers). The results are NaN for NaN and infinities, and sin -0 is -0.

// Largest angle of the fast path, with n <= 255. Up to this angle, n pi/2 is exact in the first two parts.
#define GELENK_LARGEST_DIRECT_ANGLE 400.0f

// Sine and cosine of hi - low + quadrant pi/2 with |hi| <= pi/4. low has the size of a rounding error of hi.
GELENK_INLINE void gelenk_sin_cos_quarter_f32(float hi, float low, uint32_t quadrant, float *sin_x, float *cos_x)
{
    const float z = hi * hi;
    const float p = 0.16666655f + z * (-0.008332192f + z * 0.00019518787f);
    const float q = 0.041666646f + z * (-0.0013887301f + z * 2.443067e-5f);
    const float half = 0.5f * z;
    const float w = 1.0f - half;
    const float sine = hi - (hi * z * p + low * w);
    const float cosine = w + (((1.0f - w) - half) + (z * z * q + hi * low));
    // Only the last two bits of the quadrant are used.
    const uint32_t sine_bits = gelenk_bits(sine);
    const uint32_t cosine_bits = gelenk_bits(cosine);
    const uint32_t exchange = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
    *sin_x = gelenk_from_bits(sine_bits ^ exchange ^ ((quadrant & 2) << 30));
    *cos_x = gelenk_from_bits(cosine_bits ^ exchange ^ (((quadrant + 1) & 2) << 30));
}

// Sine and cosine for |x| <= 400. The first difference is exact. The rounding error of the second difference
// is kept (Fast2Sum).
GELENK_INLINE void gelenk_sin_cos_direct_f32(float x, float *sin_x, float *cos_x)
{
    const float two_over_pi = 0.63661975f;
    const float to_integer = 12582912.0f; // 1.5 * 2^23: the sum's last bits are the nearest integer
    const float shifted = x * two_over_pi + to_integer;
    const float n = shifted - to_integer;
    const float first = x - n * 1.5707703f;
    const float second = n * 2.6063062e-5f;
    const float hi = first - second;
    const float low = n * 6.0771006e-11f - ((first - hi) - second);
    gelenk_sin_cos_quarter_f32(hi, low, gelenk_bits(shifted), sin_x, cos_x);
}

// Sine and cosine for |x| > 400 or NaN. x 2/pi modulo 4 is computed in integers from the 96 relevant bits of
// 2/pi.
GELENK_NOINLINE static void gelenk_sin_cos_large_f32(float x, float *sin_x, float *cos_x)
{
    // A zero word, then the first 224 bits of 2/pi.
    static const uint32_t two_over_pi[8] = {
        0x00000000u, 0xa2f9836eu, 0x4e441529u, 0xfc2757d1u, 0xf534ddc0u, 0xdb629599u, 0x3c439041u, 0xfe5163abu,
    };
    const uint64_t half_pi = 0xc90fdaa2u; // times 2^-31
    const uint32_t size = gelenk_bits(x) & (UINT32_MAX >> 1);
    if (size >= UINT32_C(0xff) << 23) {
        *sin_x = *cos_x = x - x;
        return;
    }
    // |x| = mantissa 2^(start - 30). The bits of 2/pi before `start` only add multiples of 4.
    const uint32_t start = (size >> 23) - 120;
    const uint64_t mantissa = (size & 0x7fffffu) | 0x800000u;
    uint64_t product[3];
    for (unsigned k = 0; k < 3; ++k) {
        const uint32_t *word = &two_over_pi[start / 32 + k];
        product[k] = mantissa * ((((uint64_t)word[0] << 32) | word[1]) << (start % 32) >> 32);
    }
    // x 2/pi = (turns modulo 4) / 2^62. The first two bits are the quadrant. The other bits are a fraction,
    // which is shifted to [-1/2, 1/2).
    const uint64_t turns = (product[0] << 32) + (product[1] + (product[2] >> 32));
    const uint32_t quadrant = (uint32_t)((turns >> 62) + (turns >> 61 & 1));
    uint64_t fraction = turns << 2;
    const uint32_t sign = (uint32_t)(fraction >> 63) << 31;
    fraction = sign != 0 ? 0 - fraction : fraction;
    uint32_t zeros = 0;
    while (fraction >> 63 == 0 && zeros < 64) {
        fraction <<= 1;
        ++zeros;
    }
    const uint64_t angle = (fraction >> 32) * half_pi; // times 2^(-63 - zeros)
    const float hi = (float)(uint32_t)(angle >> 40) * gelenk_from_bits((104 - zeros) << 23 | sign);
    const float low = (float)((uint32_t)(angle >> 16) & 0xffffffu) * -gelenk_from_bits((80 - zeros) << 23 | sign);
    gelenk_sin_cos_quarter_f32(hi, low, quadrant, sin_x, cos_x);
    *sin_x = x < 0.0f ? -*sin_x : *sin_x;
}

// Sine and cosine of x, each with an error below 0.9 ulp.
GELENK_INLINE void gelenk_sin_cos_f32(float x, float *sin_x, float *cos_x)
{
    if (x >= -GELENK_LARGEST_DIRECT_ANGLE && x <= GELENK_LARGEST_DIRECT_ANGLE) {
        gelenk_sin_cos_direct_f32(x, sin_x, cos_x);
    } else {
        gelenk_sin_cos_large_f32(x, sin_x, cos_x);
    }
}

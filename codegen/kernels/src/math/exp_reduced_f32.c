// The argument is reduced to x = k ln 2 + r with |r| <= ln 2 / 2 and ln 2 in two parts (Cody and Waite). A
// minimax polynomial follows (Remez exchange): exp x = (hi + low) 2^k with |low| < 0.08. A negative k is
// returned in two's complement.
GELENK_INLINE uint32_t gelenk_exp_reduced_f32(float x, float *hi_part, float *low_part)
{
    const float log2_e = 1.442695f;
    const float to_integer = 12582912.0f; // 1.5 * 2^23: the sum's last bits are the nearest integer
    const float shifted = x * log2_e + to_integer;
    const float k = shifted - to_integer;
    const float hi = x - k * 0.69314575f;
    const float low = k * 1.4286068e-6f;
    const float r = hi - low;
    const float r2 = r * r;
    const float p = (0.5f + r * 0.16666532f) + r2 * ((0.041666258f + r * 0.008367701f) + r2 * 0.0013947901f);
    const float sum = 1.0f + hi;
    *hi_part = sum;
    *low_part = ((1.0f - sum) + hi) + (r2 * p - low);
    return gelenk_bits(shifted) - gelenk_bits(to_integer);
}

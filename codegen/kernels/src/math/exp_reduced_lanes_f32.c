// The operations of gelenk_exp_reduced_f32 for several states.
GELENK_INLINE gelenk_group_bits gelenk_exp_reduced_lanes_f32(
    gelenk_group x, gelenk_group *hi_part, gelenk_group *low_part)
{
    const float log2_e = 1.442695f;
    const float to_integer = 12582912.0f;
    const gelenk_group shifted = x * log2_e + to_integer;
    const gelenk_group k = shifted - to_integer;
    const gelenk_group hi = x - k * 0.69314575f;
    const gelenk_group low = k * 1.4286068e-6f;
    const gelenk_group r = hi - low;
    const gelenk_group r2 = r * r;
    const gelenk_group p
        = (0.5f + r * 0.16666532f) + r2 * ((0.041666258f + r * 0.008367701f) + r2 * 0.0013947901f);
    const gelenk_group sum = 1.0f + hi;
    *hi_part = sum;
    *low_part = ((1.0f - sum) + hi) + (r2 * p - low);
    return gelenk_group_as_bits(shifted) - gelenk_bits(to_integer);
}

// Sine and cosine of the angles of several states, by the operations of gelenk_sin_cos_direct_f32 and
// gelenk_sin_cos_quarter_f32.
GELENK_INLINE void gelenk_sin_cos_direct_lanes_f32(gelenk_group x, gelenk_group *sin_x, gelenk_group *cos_x)
{
    const float two_over_pi = 0.63661975f;
    const float to_integer = 12582912.0f;
    const gelenk_group shifted = x * two_over_pi + to_integer;
    const gelenk_group n = shifted - to_integer;
    const gelenk_group first = x - n * 1.5707703f;
    const gelenk_group second = n * 2.6063062e-5f;
    const gelenk_group hi = first - second;
    const gelenk_group low = n * 6.0771006e-11f - ((first - hi) - second);
    const gelenk_group z = hi * hi;
    const gelenk_group p = 0.16666655f + z * (-0.008332192f + z * 0.00019518787f);
    const gelenk_group q = 0.041666646f + z * (-0.0013887301f + z * 2.443067e-5f);
    const gelenk_group half = 0.5f * z;
    const gelenk_group w = 1.0f - half;
    const gelenk_group sine = hi - (hi * z * p + low * w);
    const gelenk_group cosine = w + (((1.0f - w) - half) + (z * z * q + hi * low));
    const gelenk_group_bits quadrant = gelenk_group_as_bits(shifted);
    const gelenk_group_bits sine_bits = gelenk_group_as_bits(sine);
    const gelenk_group_bits cosine_bits = gelenk_group_as_bits(cosine);
    const gelenk_group_bits exchange = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
    *sin_x = gelenk_group_from_bits(sine_bits ^ exchange ^ ((quadrant & 2) << 30));
    *cos_x = gelenk_group_from_bits(cosine_bits ^ exchange ^ (((quadrant + 1) & 2) << 30));
}

// The same results as gelenk_sin_cos_f32 of each angle. This function is outside of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_large_lanes_f32(const float *x, float *sin_x, float *cos_x)
{
    for (int i = 0; i < GELENK_WIDTH; ++i) {
        gelenk_sin_cos_f32(x[i], &sin_x[i], &cos_x[i]);
    }
}

GELENK_INLINE void gelenk_sin_cos_lanes_f32(gelenk_group x, gelenk_group *sin_x, gelenk_group *cos_x)
{
    const gelenk_group largest = gelenk_same(GELENK_LARGEST_DIRECT_ANGLE);
    gelenk_sin_cos_direct_lanes_f32(x, sin_x, cos_x);
    if (!gelenk_all(gelenk_at_most(gelenk_fabs_lanes(x), largest))) {
        float angles[GELENK_WIDTH], sines[GELENK_WIDTH], cosines[GELENK_WIDTH];
        gelenk_put(angles, x);
        gelenk_sin_cos_large_lanes_f32(angles, sines, cosines);
        *sin_x = gelenk_take(sines);
        *cos_x = gelenk_take(cosines);
    }
}

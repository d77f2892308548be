// Sine and cosine of the angles of several states, by the operations of gelenk_sin_cos_direct,
// gelenk_sin_cos_quarter and gelenk_in_quadrant.
GELENK_INLINE void gelenk_sin_cos_direct_lanes(gelenk_group x, gelenk_group *sin_x, gelenk_group *cos_x)
{
    const double two_over_pi = 0.6366197723675814;
    const double to_integer = 6755399441055744.0;
    const gelenk_group shifted = x * two_over_pi + to_integer;
    const gelenk_group n = shifted - to_integer;
    const gelenk_group first = x - n * 1.5707963267923333;
    const gelenk_group second = n * 2.5633441515839558e-12;
    const gelenk_group hi = first - second;
    const gelenk_group low = n * 1.0562999066987428e-23 - ((first - hi) - second);
    const gelenk_group z = hi * hi;
    const gelenk_group z2 = z * z;
    const gelenk_group z4 = z2 * z2;
    const gelenk_group p = (0.16666666666666632 + z * -0.00833333333332249)
        + (z2 * (0.00019841269829857792 + z * -2.7557313706995275e-6)
           + z4 * (2.5050760238992093e-8 + z * -1.5896908978047454e-10));
    const gelenk_group q = (0.0416666666666666 + z * -0.0013888888888874474)
        + (z2 * (2.4801587289671523e-5 + z * -2.755731440102192e-7)
           + z4 * (2.08757292794275e-9 + z * -1.1359934120766979e-11));
    const gelenk_group half = 0.5 * z;
    const gelenk_group w = 1.0 - half;
    const gelenk_group sine = hi - (hi * z * p + low * w);
    const gelenk_group cosine = w + (((1.0 - w) - half) + (z2 * q + hi * low));
    const gelenk_group_bits quadrant = gelenk_group_as_bits(shifted);
    const gelenk_group_bits sine_bits = gelenk_group_as_bits(sine);
    const gelenk_group_bits cosine_bits = gelenk_group_as_bits(cosine);
    const gelenk_group_bits exchange = (sine_bits ^ cosine_bits) & (0 - (quadrant & 1));
    *sin_x = gelenk_group_from_bits(sine_bits ^ exchange ^ ((quadrant & 2) << 62));
    *cos_x = gelenk_group_from_bits(cosine_bits ^ exchange ^ (((quadrant + 1) & 2) << 62));
}

// The same results as gelenk_sin_cos of each angle. This function is outside of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_large_lanes(const double *x, double *sin_x, double *cos_x)
{
    for (int i = 0; i < GELENK_WIDTH; ++i) {
        gelenk_sin_cos(x[i], &sin_x[i], &cos_x[i]);
    }
}

GELENK_INLINE void gelenk_sin_cos_lanes(gelenk_group x, gelenk_group *sin_x, gelenk_group *cos_x)
{
    const gelenk_group largest = gelenk_same(GELENK_LARGEST_DIRECT_ANGLE);
    gelenk_sin_cos_direct_lanes(x, sin_x, cos_x);
    if (!gelenk_all(gelenk_at_most(gelenk_fabs_lanes(x), largest))) {
        double angles[GELENK_WIDTH], sines[GELENK_WIDTH], cosines[GELENK_WIDTH];
        gelenk_put(angles, x);
        gelenk_sin_cos_large_lanes(angles, sines, cosines);
        *sin_x = gelenk_take(sines);
        *cos_x = gelenk_take(cosines);
    }
}

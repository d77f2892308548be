// Sine and cosine for float, computed in double with shorter polynomials. Error at most 0.51 ulp of float for every
// finite x; NaN for NaN and infinities; sin -0 = -0.

// |x| <= 1e5: n pi/2 is exact in the first part, and 86 bits of pi/2 suffice for the float closest to a multiple.
GELENK_INLINE void gelenk_sin_cos_direct_f32(float x, float *sin_x, float *cos_x)
{
    const double two_over_pi = 0.6366197723675814;
    const double to_integer = 6755399441055744.0; // 1.5 * 2^52: the sum's last bits are the nearest integer
    const double shifted = (double)x * two_over_pi + to_integer;
    const double n = shifted - to_integer;
    const double r = ((double)x - n * 1.5707963267341256) - n * 6.077100506506192e-11;
    const double z = r * r;
    const double z2 = z * z;
    const double p = (0.16666666641627026 + z * -0.00833332938594328)
        + z2 * (0.00019839334851758369 + z * -2.718311630651964e-6);
    const double q = (0.041666646866486835 + z * -0.0013887367517165202) + z2 * 2.443845165061258e-5;
    double sine, cosine;
    gelenk_in_quadrant(r * (1.0 - z * p), 1.0 - (0.5 * z - z2 * q), gelenk_bits(shifted), &sine, &cosine);
    *sin_x = (float)sine;
    *cos_x = (float)cosine;
}

GELENK_NOINLINE static void gelenk_sin_cos_large_f32(float x, float *sin_x, float *cos_x)
{
    double sine, cosine;
    gelenk_sin_cos((double)x, &sine, &cosine);
    *sin_x = (float)sine;
    *cos_x = (float)cosine;
}

// Sine and cosine of x with an error of at most 0.51 ulp each.
GELENK_INLINE void gelenk_sin_cos_f32(float x, float *sin_x, float *cos_x)
{
    if (x >= -1.0e5f && x <= 1.0e5f) {
        gelenk_sin_cos_direct_f32(x, sin_x, cos_x);
    } else {
        gelenk_sin_cos_large_f32(x, sin_x, cos_x);
    }
}

// exp x with an error of at most 0.51 ulp of float, in the subnormal range too; infinite from 88.73 on, 0 below -103.98,
// NaN for NaN.
GELENK_INLINE float gelenk_exp_f32(float x)
{
    x = x > 90.0f ? 90.0f : x;
    x = x < -110.0f ? -110.0f : x;
    return (float)gelenk_exp_direct_f32((double)x);
}

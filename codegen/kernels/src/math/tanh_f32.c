// Hyperbolic tangent for float, computed in float.
//
// For |x| < 0.625 it is x - x^3 P(x^2)/Q(x^2), the fifth convergent of Lambert's continued fraction. For
// larger |x| it is 1 - 2/(exp 2x + 1). Both cases share the division. The error is below 1 ulp of float (0.89
// in a test of all numbers). The result is exactly 1 or -1 from |x| = 9.02 on, tanh -0 is -0, and tanh NaN is
// NaN.
GELENK_INLINE float gelenk_tanh_f32(float x)
{
    const float size = fabsf(x);
    const float z = size * size;
    const int is_small = size < 0.625f;
    const float p = 315.0f + z * 14.0f;
    const float q = 945.0f + z * (420.0f + z * 15.0f);
    const float limited = size > 10.0f ? 10.0f : size;
    float hi, low;
    const uint32_t k = gelenk_exp_reduced_f32(2.0f * limited, &hi, &low);
    const float power = gelenk_from_bits((k + 127) << 23);
    const float exp_x = hi + low;
    const float sum = exp_x * power + 1.0f;
    // The rounding errors of both additions in the sum.
    const float missing = (1.0f - (sum - exp_x * power)) + ((hi - exp_x) + low) * power;
    const float quotient = (is_small ? size * z * p : 2.0f) / (is_small ? q : sum);
    const float correction = is_small ? 0.0f : 0.5f * quotient * quotient * missing;
    const float base = is_small ? size : 1.0f;
    const float result = base - quotient;
    return copysignf(result + (((base - result) - quotient) + correction), x);
}

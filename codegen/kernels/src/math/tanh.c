// Hyperbolic tangent, without branches, tables or fused operations.
//
// For |x| < 0.625 it is x - x^3 P(x^2)/Q(x^2), the eighth convergent of Lambert's continued fraction x/(1 +
// x^2/(3 + x^2/(5 + ...))) (Lambert 1761), whose coefficients are integers. For larger |x| it is 1 - 2/(exp
// 2x + 1). Both cases share the division. The error is below 1 ulp (measured: 0.86). The result is exactly 1
// or -1 from |x| = 19.07 on, tanh -0 is -0, and tanh NaN is NaN.
GELENK_INLINE double gelenk_tanh(double x)
{
    const double size = fabs(x);
    const double z = size * size;
    const int is_small = size < 0.625;
    const double p = 675675.0 + z * (45045.0 + z * (594.0 + z));
    const double q = 2027025.0 + z * (945945.0 + z * (51975.0 + z * (630.0 + z)));
    const double limited = size > 20.0 ? 20.0 : size;
    double hi, low;
    const uint64_t k = gelenk_exp_reduced(2.0 * limited, &hi, &low);
    const double power = gelenk_from_bits((k + 1023) << 52);
    const double exp_x = hi + low;
    const double sum = exp_x * power + 1.0;
    // The rounding errors of both additions in the sum.
    const double missing = (1.0 - (sum - exp_x * power)) + ((hi - exp_x) + low) * power;
    const double quotient = (is_small ? size * z * p : 2.0) / (is_small ? q : sum);
    const double correction = is_small ? 0.0 : 0.5 * quotient * quotient * missing;
    const double base = is_small ? size : 1.0;
    const double result = base - quotient;
    return copysign(result + (((base - result) - quotient) + correction), x);
}

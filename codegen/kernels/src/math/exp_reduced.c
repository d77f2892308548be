// The argument is reduced to x = k ln 2 + r with |r| <= ln 2 / 2 and ln 2 in two parts (Cody and Waite,
// Software Manual for the Elementary Functions, 1980, ch. 6). A minimax polynomial follows (Remez exchange):
// exp x = (hi + low) 2^k with |low| < 0.08. A negative k is returned in two's complement.
GELENK_INLINE uint64_t gelenk_exp_reduced(double x, double *hi_part, double *low_part)
{
    const double log2_e = 1.4426950408889634;
    const double to_integer = 6755399441055744.0; // 1.5 * 2^52: the sum's last bits are the nearest integer
    const double shifted = x * log2_e + to_integer;
    const double k = shifted - to_integer;
    const double hi = x - k * 0.6931471805598903;
    const double low = k * 5.497923018708371e-14;
    const double r = hi - low;
    const double r2 = r * r;
    const double r4 = r2 * r2;
    const double p = (0.5000000000000003 + r * 0.16666666666666685)
        + r2 * (0.041666666666586645 + r * 0.008333333333315226)
        + r4 * ((0.001388888892985391 + r * 0.00019841269902211344)
                + r2 * (2.480150641915018e-5 + r * 2.7557228365358775e-6)
                + r4 * (2.762578738025877e-7 + r * 2.511441141799656e-8));
    const double sum = 1.0 + hi;
    *hi_part = sum;
    *low_part = ((1.0 - sum) + hi) + (r2 * p - low);
    return gelenk_bits(shifted) - gelenk_bits(to_integer);
}

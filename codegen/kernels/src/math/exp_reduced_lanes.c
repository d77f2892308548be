// The operations of gelenk_exp_reduced for several states.
GELENK_INLINE gelenk_group_bits gelenk_exp_reduced_lanes(gelenk_group x, gelenk_group *hi_part, gelenk_group *low_part)
{
    const double log2_e = 1.4426950408889634;
    const double to_integer = 6755399441055744.0;
    const gelenk_group shifted = x * log2_e + to_integer;
    const gelenk_group k = shifted - to_integer;
    const gelenk_group hi = x - k * 0.6931471805598903;
    const gelenk_group low = k * 5.497923018708371e-14;
    const gelenk_group r = hi - low;
    const gelenk_group r2 = r * r;
    const gelenk_group r4 = r2 * r2;
    const gelenk_group p = (0.5000000000000003 + r * 0.16666666666666685)
        + r2 * (0.041666666666586645 + r * 0.008333333333315226)
        + r4 * ((0.001388888892985391 + r * 0.00019841269902211344)
                + r2 * (2.480150641915018e-5 + r * 2.7557228365358775e-6)
                + r4 * (2.762578738025877e-7 + r * 2.511441141799656e-8));
    const gelenk_group sum = 1.0 + hi;
    *hi_part = sum;
    *low_part = ((1.0 - sum) + hi) + (r2 * p - low);
    return gelenk_group_as_bits(shifted) - gelenk_bits(to_integer);
}

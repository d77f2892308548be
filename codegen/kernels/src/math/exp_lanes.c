// The operations of gelenk_exp for several states.
GELENK_INLINE gelenk_group gelenk_exp_lanes(gelenk_group x)
{
    gelenk_group hi, low;
    x = gelenk_choose(gelenk_less(gelenk_same(710.0), x), gelenk_same(710.0), x);
    x = gelenk_choose(gelenk_less(x, gelenk_same(-746.0)), gelenk_same(-746.0), x);
    const gelenk_group_bits k = gelenk_exp_reduced_lanes(x, &hi, &low);
    const gelenk_group_bits biased = k + 2048;
    const gelenk_group_bits first = biased >> 1;
    const gelenk_group_bits second = biased - first;
    return (hi + low) * gelenk_group_from_bits((first - 1) << 52) * gelenk_group_from_bits((second - 1) << 52);
}

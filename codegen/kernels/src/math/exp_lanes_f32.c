// The operations of gelenk_exp_f32 for several states.
GELENK_INLINE gelenk_group gelenk_exp_lanes_f32(gelenk_group x)
{
    gelenk_group hi, low;
    x = gelenk_choose(gelenk_less(gelenk_same(90.0f), x), gelenk_same(90.0f), x);
    x = gelenk_choose(gelenk_less(x, gelenk_same(-105.0f)), gelenk_same(-105.0f), x);
    const gelenk_group_bits k = gelenk_exp_reduced_lanes_f32(x, &hi, &low);
    const gelenk_group_bits biased = k + 256;
    const gelenk_group_bits first = biased >> 1;
    const gelenk_group_bits second = biased - first;
    return (hi + low) * gelenk_group_from_bits((first - 1) << 23) * gelenk_group_from_bits((second - 1) << 23);
}

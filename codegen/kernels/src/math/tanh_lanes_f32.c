// The operations of gelenk_tanh_f32 for several states.
GELENK_INLINE gelenk_group gelenk_tanh_lanes_f32(gelenk_group x)
{
    const gelenk_group size = gelenk_fabs_lanes(x);
    const gelenk_group z = size * size;
    const gelenk_group_bits is_small = gelenk_less(size, gelenk_same(0.625f));
    const gelenk_group p = 315.0f + z * 14.0f;
    const gelenk_group q = 945.0f + z * (420.0f + z * 15.0f);
    const gelenk_group limited = gelenk_choose(gelenk_less(gelenk_same(10.0f), size), gelenk_same(10.0f), size);
    gelenk_group hi, low;
    const gelenk_group_bits k = gelenk_exp_reduced_lanes_f32(2.0f * limited, &hi, &low);
    const gelenk_group power = gelenk_group_from_bits((k + 127) << 23);
    const gelenk_group exp_x = hi + low;
    const gelenk_group sum = exp_x * power + 1.0f;
    const gelenk_group missing = (1.0f - (sum - exp_x * power)) + ((hi - exp_x) + low) * power;
    const gelenk_group quotient
        = gelenk_choose(is_small, size * z * p, gelenk_same(2.0f)) / gelenk_choose(is_small, q, sum);
    const gelenk_group correction = gelenk_choose(is_small, gelenk_same(0.0f), 0.5f * quotient * quotient * missing);
    const gelenk_group base = gelenk_choose(is_small, size, gelenk_same(1.0f));
    const gelenk_group result = base - quotient;
    return gelenk_with_sign(result + (((base - result) - quotient) + correction), x);
}

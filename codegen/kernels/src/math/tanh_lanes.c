// The operations of gelenk_tanh for several states.
GELENK_INLINE gelenk_group gelenk_tanh_lanes(gelenk_group x)
{
    const gelenk_group size = gelenk_fabs_lanes(x);
    const gelenk_group z = size * size;
    const gelenk_group_bits is_small = gelenk_less(size, gelenk_same(0.625));
    const gelenk_group p = 675675.0 + z * (45045.0 + z * (594.0 + z));
    const gelenk_group q = 2027025.0 + z * (945945.0 + z * (51975.0 + z * (630.0 + z)));
    const gelenk_group limited = gelenk_choose(gelenk_less(gelenk_same(20.0), size), gelenk_same(20.0), size);
    gelenk_group hi, low;
    const gelenk_group_bits k = gelenk_exp_reduced_lanes(2.0 * limited, &hi, &low);
    const gelenk_group power = gelenk_group_from_bits((k + 1023) << 52);
    const gelenk_group exp_x = hi + low;
    const gelenk_group sum = exp_x * power + 1.0;
    const gelenk_group missing = (1.0 - (sum - exp_x * power)) + ((hi - exp_x) + low) * power;
    const gelenk_group quotient
        = gelenk_choose(is_small, size * z * p, gelenk_same(2.0)) / gelenk_choose(is_small, q, sum);
    const gelenk_group correction = gelenk_choose(is_small, gelenk_same(0.0), 0.5 * quotient * quotient * missing);
    const gelenk_group base = gelenk_choose(is_small, size, gelenk_same(1.0));
    const gelenk_group result = base - quotient;
    return gelenk_with_sign(result + (((base - result) - quotient) + correction), x);
}

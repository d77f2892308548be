
GELENK_OF_GROUP gelenk_group_bits gelenk_group_as_bits(gelenk_group x)
{
    gelenk_group_bits bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

GELENK_OF_GROUP gelenk_group gelenk_group_from_bits(gelenk_group_bits bits)
{
    gelenk_group x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

// Comparisons: all bits of a state are set if the comparison is true for this state; otherwise none is set.
#if defined(__GNUC__)
#define GELENK_MASK(comparison) ((gelenk_group_bits)(comparison))
#else
#define GELENK_MASK(comparison) (0 - (gelenk_group_bits)(comparison))
#endif

GELENK_OF_GROUP gelenk_group_bits gelenk_less(gelenk_group a, gelenk_group b)
{
    return GELENK_MASK(a < b);
}

GELENK_OF_GROUP gelenk_group_bits gelenk_at_most(gelenk_group a, gelenk_group b)
{
    return GELENK_MASK(a <= b);
}

// Whether a comparison is true for all states.
GELENK_OF_GROUP int gelenk_all(gelenk_group_bits mask)
{
    uint64_t each[GELENK_WIDTH], all = UINT64_MAX;
    memcpy(each, &mask, sizeof each);
    for (int i = 0; i < GELENK_WIDTH; ++i) {
        all &= each[i];
    }
    return all != 0;
}

// a if the comparison is true, otherwise b.
GELENK_OF_GROUP gelenk_group gelenk_choose(gelenk_group_bits mask, gelenk_group a, gelenk_group b)
{
    return gelenk_group_from_bits((gelenk_group_as_bits(a) & mask) | (gelenk_group_as_bits(b) & ~mask));
}

// The magnitude of x with the sign of another number.
GELENK_OF_GROUP gelenk_group gelenk_with_sign(gelenk_group x, gelenk_group sign)
{
    const uint64_t size = UINT64_MAX >> 1;
    return gelenk_group_from_bits((gelenk_group_as_bits(x) & size) | (gelenk_group_as_bits(sign) & ~size));
}

GELENK_OF_GROUP gelenk_group gelenk_fabs_lanes(gelenk_group x)
{
    return gelenk_group_from_bits(gelenk_group_as_bits(x) & (UINT64_MAX >> 1));
}

GELENK_OF_GROUP gelenk_group gelenk_negated_lanes(gelenk_group x)
{
    return gelenk_group_from_bits(gelenk_group_as_bits(x) ^ ~(UINT64_MAX >> 1));
}

GELENK_OF_GROUP gelenk_group gelenk_sign_lanes(gelenk_group x)
{
    const gelenk_group zero = gelenk_same(0.0);
    const gelenk_group other = gelenk_choose(GELENK_MASK(x == zero), zero, x);
    const gelenk_group negative = gelenk_choose(gelenk_less(x, zero), gelenk_same(-1.0), other);
    return gelenk_choose(gelenk_less(zero, x), gelenk_same(1.0), negative);
}

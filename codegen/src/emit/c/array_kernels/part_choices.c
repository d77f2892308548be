// a if the bits are set, otherwise b.
GELENK_INLINE gelenk_part gelenk_choose_part(gelenk_part_bits bits, gelenk_part a, gelenk_part b)
{
    gelenk_part_bits a_bits, b_bits;
    memcpy(&a_bits, &a, sizeof a_bits);
    memcpy(&b_bits, &b, sizeof b_bits);
    a_bits = (a_bits & bits) | (b_bits & ~bits);
    memcpy(&a, &a_bits, sizeof a);
    return a;
}

// Comparison of columns. All bits of a column are set if the comparison is true for this column; otherwise
// none is set.
#if GELENK_PART == 1
#define GELENK_HOLDS(comparison) (0 - (gelenk_part_bits)(comparison))
#else
#define GELENK_HOLDS(comparison) ((gelenk_part_bits)(comparison))
#endif

// The indices of the columns of the part that begins at column `first`.
GELENK_INLINE gelenk_part_bits gelenk_columns(int first)
{
    static const uint64_t from_zero[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    gelenk_part_bits columns;
    memcpy(&columns, from_zero, sizeof columns);
    return columns + (uint64_t)first;
}

// A mask with the bits of column i.
GELENK_INLINE gelenk_part_bits gelenk_column(int first, int i)
{
    return GELENK_HOLDS(gelenk_columns(first) == (uint64_t)i);
}

// These columns, and their bits. Operators work on each of them.
#if GELENK_PART == 1
typedef double gelenk_part;
typedef uint64_t gelenk_part_bits;
#else
typedef double gelenk_part __attribute__((vector_size(sizeof(double) * GELENK_PART)));
typedef uint64_t gelenk_part_bits __attribute__((vector_size(sizeof(double) * GELENK_PART)));
#endif

GELENK_INLINE gelenk_part gelenk_part_of(const double *row)
{
    gelenk_part part;
    memcpy(&part, row, sizeof part);
    return part;
}

GELENK_INLINE void gelenk_put_part(double *row, gelenk_part part)
{
    memcpy(row, &part, sizeof part);
}

// One number for all columns: zero taken away leaves every number as it is.
GELENK_INLINE gelenk_part gelenk_same_part(double x)
{
    const gelenk_part zero = {0};
    return x - zero;
}

// a where the bits are set, b where they are not.
GELENK_INLINE gelenk_part gelenk_choose_part(gelenk_part_bits bits, gelenk_part a, gelenk_part b)
{
    gelenk_part_bits a_bits, b_bits;
    memcpy(&a_bits, &a, sizeof a_bits);
    memcpy(&b_bits, &b, sizeof b_bits);
    a_bits = (a_bits & bits) | (b_bits & ~bits);
    memcpy(&a, &a_bits, sizeof a);
    return a;
}

// Comparisons of columns: all bits of those are set for which they hold, none of the others.
#if GELENK_PART == 1
#define GELENK_HOLDS(comparison) (0 - (gelenk_part_bits)(comparison))
#else
#define GELENK_HOLDS(comparison) ((gelenk_part_bits)(comparison))
#endif

// The numbers of the columns of the part that begins at a column.
GELENK_INLINE gelenk_part_bits gelenk_columns(int first)
{
    static const uint64_t from_zero[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    gelenk_part_bits columns;
    memcpy(&columns, from_zero, sizeof columns);
    return columns + (uint64_t)first;
}

// The bits of column i.
GELENK_INLINE gelenk_part_bits gelenk_column(int first, int i)
{
    return GELENK_HOLDS(gelenk_columns(first) == (uint64_t)i);
}

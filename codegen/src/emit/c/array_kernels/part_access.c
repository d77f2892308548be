// The columns of a part of a row, and their bits. Operators act on each column.
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

// The same number in all columns. The subtraction of zero does not change a number.
GELENK_INLINE gelenk_part gelenk_same_part(double x)
{
    const gelenk_part zero = {0};
    return x - zero;
}

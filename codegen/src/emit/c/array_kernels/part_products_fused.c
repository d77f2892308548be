// sum + a b of each column, rounded once
#if defined(__GNUC__) && defined(__has_builtin)
#if __has_builtin(__builtin_elementwise_fma)
#define GELENK_FMA_OF_PARTS __builtin_elementwise_fma
#endif
#endif
GELENK_INLINE gelenk_part gelenk_add_part(gelenk_part sum, gelenk_part a, gelenk_part b)
{
#if GELENK_PART == 1
    return fma(a, b, sum);
#elif defined(GELENK_FMA_OF_PARTS)
    return GELENK_FMA_OF_PARTS(a, b, sum);
#else
    double sums[GELENK_PART], each_a[GELENK_PART], each_b[GELENK_PART];
    gelenk_put_part(sums, sum);
    gelenk_put_part(each_a, a);
    gelenk_put_part(each_b, b);
    // If the loop was unrolled, it would become operations on single numbers.
#if __GNUC__ >= 8
#pragma GCC unroll 1
#endif
    for (int i = 0; i < GELENK_PART; ++i) {
        sums[i] = fma(each_a[i], each_b[i], sums[i]);
    }
    return gelenk_part_of(sums);
#endif
}

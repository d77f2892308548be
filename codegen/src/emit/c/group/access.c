
GELENK_OF_GROUP gelenk_group gelenk_take(const double *x)
{
    gelenk_group group;
    memcpy(&group, x, sizeof group);
    return group;
}

GELENK_OF_GROUP void gelenk_put(double *x, gelenk_group group)
{
    memcpy(x, &group, sizeof group);
}

// The same number for all states. The subtraction of zero does not change a number.
GELENK_OF_GROUP gelenk_group gelenk_same(double x)
{
    gelenk_group zero = {0};
    return x - zero;
}

// The same entry of several states. `step` is the distance between the entries of adjacent states.
GELENK_OF_GROUP gelenk_group gelenk_gather(const double *x, int step)
{
#if GELENK_WIDTH == 8
    const gelenk_group group
        = {x[0], x[step], x[2 * step], x[3 * step], x[4 * step], x[5 * step], x[6 * step], x[7 * step]};
#elif GELENK_WIDTH == 4
    const gelenk_group group = {x[0], x[step], x[2 * step], x[3 * step]};
#elif GELENK_WIDTH == 2
    const gelenk_group group = {x[0], x[step]};
#else
    const gelenk_group group = x[0];
    (void)step;
#endif
    return group;
}

GELENK_OF_GROUP void gelenk_scatter(double *x, int step, gelenk_group group)
{
#if GELENK_WIDTH == 1
    x[0] = group;
    (void)step;
#else
    x[0] = group[0];
    x[step] = group[1];
#if GELENK_WIDTH >= 4
    x[2 * step] = group[2];
    x[3 * step] = group[3];
#endif
#if GELENK_WIDTH == 8
    x[4 * step] = group[4];
    x[5 * step] = group[5];
    x[6 * step] = group[6];
    x[7 * step] = group[7];
#endif
#endif
}

// Writes two adjacent entries of several states.
#if defined(__GNUC__) && defined(__has_builtin)
#if __has_builtin(__builtin_shufflevector)
#define GELENK_HAS_SHUFFLE
#endif
#endif
GELENK_OF_GROUP void gelenk_scatter_pair(double *x, int step, gelenk_group a, gelenk_group b)
{
#if defined(GELENK_HAS_SHUFFLE) && GELENK_WIDTH == 4
    typedef double pair __attribute__((vector_size(2 * sizeof(double))));
    const gelenk_group even = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    const pair first = __builtin_shufflevector(even, even, 0, 1), second = __builtin_shufflevector(odd, odd, 0, 1);
    const pair third = __builtin_shufflevector(even, even, 2, 3), fourth = __builtin_shufflevector(odd, odd, 2, 3);
    memcpy(x, &first, sizeof first);
    memcpy(&x[step], &second, sizeof second);
    memcpy(&x[2 * step], &third, sizeof third);
    memcpy(&x[3 * step], &fourth, sizeof fourth);
#else
    gelenk_scatter(x, step, a);
    gelenk_scatter(&x[1], step, b);
#endif
}

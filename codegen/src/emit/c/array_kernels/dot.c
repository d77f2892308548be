// a b in four partial sums: one alone would wait for each of its terms.
GELENK_INLINE double gelenk_dot(int count, const double *a, const double *b)
{
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < count; ++k) {
        sums[k % 4] = gelenk_add_product(sums[k % 4], a[k], b[k]);
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

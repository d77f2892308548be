// The sum over r of by_i[r][i] by_j[r][j], for the K columns j from `first` on.
GELENK_INLINE void gelenk_products(int rows, const double *by_i, const double *by_j, int i, int first, double *sums)
{
    for (int lane = 0; lane < GELENK_K; ++lane) {
        sums[lane] = by_i[i] * by_j[first + lane];
    }
    for (int r = 1; r < rows; ++r) {
        for (int lane = 0; lane < GELENK_K; ++lane) {
            sums[lane] = gelenk_add_product(sums[lane], by_i[r * GELENK_L + i], by_j[r * GELENK_L + first + lane]);
        }
    }
}

// A matrix over the pairs of a chain's joints, K columns at a time: the sum over r of before_i[r][i] before_j[r][j] for
// j < i, diagonal[i], and the sum over r of beyond_i[r][i] beyond_j[r][j] for j > i.
GELENK_INLINE void gelenk_pairs(int before, const double *before_i, const double *before_j, int beyond,
    const double *beyond_i, const double *beyond_j, const double *diagonal, int width, double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double lower[GELENK_L] = {0.0}, upper[GELENK_L] = {0.0}, row[GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_K) {
            if (first < i) {
                gelenk_products(before, before_i, before_j, i, first, &lower[first]);
            }
            if (first + GELENK_K > i) {
                gelenk_products(beyond, beyond_i, beyond_j, i, first, &upper[first]);
            }
        }
        for (int j = 0; j < GELENK_L; ++j) {
            const double other = j > i ? upper[j] : diagonal[i];
            row[j] = j < i ? lower[j] : other;
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

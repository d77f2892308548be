// A matrix over the pairs of a tree's joints, K columns at a time: the sum over r of before_i[r][i] before_j[r][j] where j
// is before i on its path to the base (its relation is -1), diagonal[i], the sum over r of beyond_i[r][i] beyond_j[r][j]
// where i is before j (1), and 0 elsewhere.
GELENK_INLINE void gelenk_pairs(int before, const double *before_i, const double *before_j, int beyond,
    const double *beyond_i, const double *beyond_j, const double *diagonal, int width, double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double lower[GELENK_L], upper[GELENK_L], row[GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_K) {
            gelenk_products(before, before_i, before_j, i, first, &lower[first]);
            gelenk_products(beyond, beyond_i, beyond_j, i, first, &upper[first]);
        }
        for (int j = 0; j < GELENK_L; ++j) {
            const int relation = gelenk_relations[i][j];
            const double other = relation > 0 ? upper[j] : 0.0;
            row[j] = relation < 0 ? lower[j] : j == i ? diagonal[i] : other;
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

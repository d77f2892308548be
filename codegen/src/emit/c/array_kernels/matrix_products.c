// to = -left right
GELENK_INLINE void gelenk_negative_product(const double *left, const double *right, int width,
    double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double row[GELENK_L];
        for (int j = 0; j < GELENK_L; ++j) {
            row[j] = -left[i * GELENK_L] * right[j];
        }
        for (int k = 1; k < GELENK_N; ++k) {
            const double factor = -left[i * GELENK_L + k];
            for (int j = 0; j < GELENK_L; ++j) {
                row[j] = gelenk_add_product(row[j], factor, right[k * GELENK_L + j]);
            }
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

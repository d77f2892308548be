// Inverse of a symmetric positive definite matrix in place, by Gauss and Jordan without pivots. From the leaves to the
// base, only joints on one path meet.
GELENK_INLINE void gelenk_invert(double *matrix)
{
    for (int step = GELENK_N - 1; step >= 0; --step) {
        const int k = GELENK_PIVOT(step);
        double own[GELENK_L];
        const double reciprocal = 1.0 / matrix[k * GELENK_L + k];
        for (int j = 0; j < GELENK_L; ++j) {
            own[j] = matrix[k * GELENK_L + j] * reciprocal;
        }
        for (int i = 0; i < GELENK_N; ++i) {
            double *row = &matrix[i * GELENK_L];
            if (GELENK_MEET(i, k)) {
                const double factor = -row[k];
                for (int j = 0; j < GELENK_L; ++j) {
                    row[j] = gelenk_add_product(row[j], factor, own[j]);
                }
                row[k] = factor * reciprocal;
            }
        }
        memcpy(&matrix[k * GELENK_L], own, sizeof own);
        matrix[k * GELENK_L + k] = reciprocal;
    }
}

// to = matrix vector for a symmetric matrix.
GELENK_INLINE void gelenk_apply(const double *GELENK_RESTRICT matrix, const double *GELENK_RESTRICT vector,
    double *GELENK_RESTRICT to)
{
    for (int j = 0; j < GELENK_L; ++j) {
        to[j] = vector[0] * matrix[j];
    }
    for (int k = 1; k < GELENK_N; ++k) {
        for (int j = 0; j < GELENK_L; ++j) {
            to[j] = gelenk_add_product(to[j], vector[k], matrix[k * GELENK_L + j]);
        }
    }
}

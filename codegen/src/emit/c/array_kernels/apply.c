// Product to = matrix vector of a symmetric matrix and a vector.
GELENK_INLINE void gelenk_apply(const double *GELENK_RESTRICT matrix, const double *GELENK_RESTRICT vector,
    double *GELENK_RESTRICT to)
{
    for (int first = 0; first < GELENK_L; first += GELENK_PART) {
        gelenk_part sums = gelenk_same_part(vector[0]) * gelenk_part_of(&matrix[first]);
        for (int k = 1; k < GELENK_N; ++k) {
            const gelenk_part row = gelenk_part_of(&matrix[k * GELENK_L + first]);
            sums = gelenk_add_part(sums, gelenk_same_part(vector[k]), row);
        }
        gelenk_put_part(&to[first], sums);
    }
}

// Inverse of a symmetric positive definite matrix in place, by Gauss-Jordan elimination without pivoting.
// From the leaves to the base, only rows of joints on one path are combined.
//
// Whole parts of rows are combined, and a bit mask selects the new entries of the pivot column. If these
// entries were stored separately, the next step would have to wait for these stores.
GELENK_INLINE void gelenk_invert(double *matrix)
{
    for (int step = GELENK_N - 1; step >= 0; --step) {
        const int k = GELENK_PIVOT(step);
        double *own = &matrix[k * GELENK_L];
        const gelenk_part reciprocal = gelenk_same_part(1.0 / own[k]);
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            const gelenk_part scaled = gelenk_part_of(&own[first]) * reciprocal;
            gelenk_put_part(&own[first], gelenk_choose_part(gelenk_column(first, k), reciprocal, scaled));
        }
        for (int i = 0; i < GELENK_N; ++i) {
            double *row = &matrix[i * GELENK_L];
            if (GELENK_MEET(i, k)) {
                const gelenk_part factor = gelenk_same_part(-row[k]);
                for (int first = 0; first < GELENK_L; first += GELENK_PART) {
                    const gelenk_part_bits is_own = gelenk_column(first, k);
                    // -0 + x is x, even for the sign of zero.
                    const gelenk_part zero = gelenk_same_part(-0.0);
                    const gelenk_part old = gelenk_choose_part(is_own, zero, gelenk_part_of(&row[first]));
                    gelenk_put_part(&row[first], gelenk_add_part(old, factor, gelenk_part_of(&own[first])));
                }
            }
        }
    }
}

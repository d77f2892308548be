// Inverse of a symmetric positive definite matrix in place, by Gauss and Jordan without pivots. From the leaves to the
// base, only joints on one path meet.
//
// Whole parts are combined, with what becomes of the pivot's column chosen by bits: single entries stored after them
// would make the next step wait for these stores.
GELENK_INLINE void gelenk_invert(double *matrix)
{
    for (int step = GELENK_N - 1; step >= 0; --step) {
        const int k = GELENK_PIVOT(step);
        const double reciprocal = 1.0 / matrix[k * GELENK_L + k];
        double factors[GELENK_N];
        for (int i = 0; i < GELENK_N; ++i) {
            factors[i] = -matrix[i * GELENK_L + k];
        }
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            const gelenk_part_bits is_own = gelenk_column(first, k);
            const gelenk_part scale = gelenk_same_part(reciprocal);
            const gelenk_part scaled = gelenk_part_of(&matrix[k * GELENK_L + first]) * scale;
            const gelenk_part own = gelenk_choose_part(is_own, scale, scaled);
            gelenk_put_part(&matrix[k * GELENK_L + first], own);
            for (int i = 0; i < GELENK_N; ++i) {
                double *row = &matrix[i * GELENK_L + first];
                if (GELENK_MEET(i, k)) {
                    // -0 + x is x, with the sign of zero too.
                    const gelenk_part old = gelenk_choose_part(is_own, gelenk_same_part(-0.0), gelenk_part_of(row));
                    gelenk_put_part(row, gelenk_add_part(old, gelenk_same_part(factors[i]), own));
                }
            }
        }
    }
}

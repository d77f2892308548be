// A matrix over the pairs of a chain's joints, computed in parts of rows. Its entries are the sum over r of
// before_i[r][i] before_j[r][j] if j < i, diagonal[i] if j = i, and the sum over r of beyond_i[r][i]
// beyond_j[r][j] if j > i.
GELENK_INLINE void gelenk_pairs(int before, const double *before_i, const double *before_j, int beyond,
    const double *beyond_i, const double *beyond_j, const double *diagonal, int width, double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double row[GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            gelenk_part part = gelenk_same_part(diagonal[i]);
            if (first + GELENK_PART - 1 > i) {
                const gelenk_part upper = gelenk_products(beyond, beyond_i, beyond_j, i, first);
                part = gelenk_choose_part(gelenk_column(first, i), part, upper);
            }
            if (first < i) {
                const gelenk_part_bits is_before = GELENK_HOLDS(gelenk_columns(first) < (uint64_t)i);
                const gelenk_part lower = gelenk_products(before, before_i, before_j, i, first);
                part = gelenk_choose_part(is_before, lower, part);
            }
            gelenk_put_part(&row[first], part);
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

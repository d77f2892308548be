// Product to = -left right, two rows at a time, so that entries of the right matrix are loaded once for both
// rows.
GELENK_INLINE void gelenk_negative_product(const double *left, const double *right, int width,
    double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; i += 2) {
        const double *one = &left[i * GELENK_L], *other = i + 1 < GELENK_N ? one + GELENK_L : one;
        double rows[2][GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            gelenk_part sums = gelenk_same_part(-one[0]) * gelenk_part_of(&right[first]);
            gelenk_part other_sums = gelenk_same_part(-other[0]) * gelenk_part_of(&right[first]);
            for (int k = 1; k < GELENK_N; ++k) {
                const gelenk_part entries = gelenk_part_of(&right[k * GELENK_L + first]);
                sums = gelenk_add_part(sums, gelenk_same_part(-one[k]), entries);
                other_sums = gelenk_add_part(other_sums, gelenk_same_part(-other[k]), entries);
            }
            gelenk_put_part(&rows[0][first], sums);
            gelenk_put_part(&rows[1][first], other_sums);
        }
        memcpy(&to[i * width], rows[0], (size_t)width * sizeof *to);
        if (i + 1 < GELENK_N) {
            memcpy(&to[(i + 1) * width], rows[1], (size_t)width * sizeof *to);
        }
    }
}

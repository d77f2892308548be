// to = -left right
GELENK_INLINE void gelenk_negative_product(const double *left, const double *right, int width,
    double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double row[GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            gelenk_part sums = gelenk_same_part(-left[i * GELENK_L]) * gelenk_part_of(&right[first]);
            for (int k = 1; k < GELENK_N; ++k) {
                const gelenk_part factor = gelenk_same_part(-left[i * GELENK_L + k]);
                sums = gelenk_add_part(sums, factor, gelenk_part_of(&right[k * GELENK_L + first]));
            }
            gelenk_put_part(&row[first], sums);
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

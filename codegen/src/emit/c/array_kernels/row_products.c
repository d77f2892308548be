// The sum over r of by_i[r][i] by_j[r][j], for the columns j of a part of a row.
GELENK_INLINE gelenk_part gelenk_products(int rows, const double *by_i, const double *by_j, int i, int first)
{
    gelenk_part sums = gelenk_same_part(by_i[i]) * gelenk_part_of(&by_j[first]);
    for (int r = 1; r < rows; ++r) {
        const gelenk_part factor = gelenk_same_part(by_i[r * GELENK_L + i]);
        sums = gelenk_add_part(sums, factor, gelenk_part_of(&by_j[r * GELENK_L + first]));
    }
    return sums;
}

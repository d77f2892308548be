// A mask with the bits of the columns that have this relation.
GELENK_INLINE gelenk_part_bits gelenk_related(const int64_t *relations, int relation)
{
    gelenk_part_bits bits;
    memcpy(&bits, relations, sizeof bits);
    return GELENK_HOLDS(bits == (uint64_t)relation);
}

// A matrix over the pairs of a tree's joints, computed in parts of rows. Its entries are
//
// - the sum over r of before_i[r][i] before_j[r][j] if j is before i on its path to the base (relation -1)
// - diagonal[i] if j = i
// - the sum over r of beyond_i[r][i] beyond_j[r][j] if i is before j (relation 1)
// - 0 otherwise
GELENK_INLINE void gelenk_pairs(int before, const double *before_i, const double *before_j, int beyond,
    const double *beyond_i, const double *beyond_j, const double *diagonal, int width, double *GELENK_RESTRICT to)
{
    for (int i = 0; i < GELENK_N; ++i) {
        double row[GELENK_L];
        for (int first = 0; first < GELENK_L; first += GELENK_PART) {
            const int64_t *relations = &gelenk_relations[i][first];
            const gelenk_part lower = gelenk_products(before, before_i, before_j, i, first);
            const gelenk_part upper = gelenk_products(beyond, beyond_i, beyond_j, i, first);
            gelenk_part part = gelenk_choose_part(gelenk_related(relations, 1), upper, gelenk_same_part(0.0));
            part = gelenk_choose_part(gelenk_column(first, i), gelenk_same_part(diagonal[i]), part);
            gelenk_put_part(&row[first], gelenk_choose_part(gelenk_related(relations, -1), lower, part));
        }
        memcpy(&to[i * width], row, (size_t)width * sizeof *row);
    }
}

// Half of a matrix over the state (y, v). Each row has a left and a right block.
#define GELENK_ROW (2 * GELENK_N)
#define GELENK_HALF (GELENK_N * GELENK_ROW)

// Number of entries of a matrix with one column per input. It is at least 1, because C has no arrays without
// entries.
#define GELENK_BY_INPUTS (GELENK_M > 0 ? GELENK_N * GELENK_M : 1)

// Adds factor a.
static inline void gelenk_add_scaled(int count, double *sum, double factor, const double *a)
{
    for (int i = 0; i < count; ++i) {
        sum[i] += factor * a[i];
    }
}

// Adds the product a B to a row, with half a matrix B over the state.
static inline void gelenk_add_row(double *sum, const double *a, const double *b)
{
    double row[GELENK_ROW];
    memcpy(row, sum, sizeof row);
    for (int k = 0; k < GELENK_N; ++k) {
        for (int j = 0; j < GELENK_ROW; ++j) {
            row[j] += a[k] * b[k * GELENK_ROW + j];
        }
    }
    memcpy(sum, row, sizeof row);
}

// Adds the rows of b, each times its entry of a, to a row with one entry per input.
static inline void gelenk_add_combination(double *sum, const double *a, const double *b)
{
    for (int k = 0; k < GELENK_N; ++k) {
        gelenk_add_scaled(GELENK_M, sum, a[k], &b[k * GELENK_M]);
    }
}

static inline double gelenk_dot_product(int count, const double *a, const double *b)
{
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        sum += a[i] * b[i];
    }
    return sum;
}

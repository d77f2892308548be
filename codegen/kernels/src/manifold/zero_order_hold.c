// Adds the rows of b times the entries of a. Each row has `columns` entries.
static void gelenk_add_rows(int columns, double *sum, const double *a, const double *b)
{
    for (int k = 0; k < GELENK_N; ++k) {
        gelenk_add_scaled(columns, sum, a[k], &b[k * columns]);
    }
}

// Exact solution of d' = D d + v, v' = A_y d + A_v v + B_x u + c over a period with constant inputs, for the
// state x = (d, v).
//
// With w = D d + v, the system is d' = w, w' = (A_y - A_v D) d + (A_v + D) w + B_x u + c, which
// `zero_order_hold` solves.
static void gelenk_zero_order_hold_on_manifold(const double *by_y, const double *by_v, const double *by_u,
    const double *remainder, const double *drift, double period, double *state, double *input, double *affine)
{
    const int square = GELENK_N * GELENK_N;
    double by_d[GELENK_N * GELENK_N], by_w[GELENK_N * GELENK_N], row[GELENK_N];
    memcpy(by_d, by_y, sizeof by_d);
    memcpy(by_w, by_v, sizeof by_w);
    for (int i = 0; i < GELENK_N; ++i) {
        for (int j = 0; j < GELENK_N; ++j) {
            row[j] = -by_v[i * GELENK_N + j];
        }
        gelenk_add_rows(GELENK_N, &by_d[i * GELENK_N], row, drift);
        gelenk_add_scaled(GELENK_N, &by_w[i * GELENK_N], 1.0, &drift[i * GELENK_N]);
    }
    gelenk_zero_order_hold(by_d, by_w, by_u, remainder, period, state, input, affine);
    // The rate w is replaced by v + D d, first in the initial state, then in the final state.
    for (int half = 0; half < 2; ++half) {
        for (int i = 0; i < GELENK_N; ++i) {
            double *left = &state[2 * half * square + i * GELENK_N];
            gelenk_add_rows(GELENK_N, left, &left[square], drift);
        }
    }
    for (int i = 0; i < GELENK_N; ++i) {
        for (int j = 0; j < GELENK_N; ++j) {
            row[j] = -drift[i * GELENK_N + j];
        }
        for (int block = 0; block < 2; ++block) {
            double *upper = &state[block * square];
            gelenk_add_rows(GELENK_N, &upper[2 * square + i * GELENK_N], row, upper);
        }
        gelenk_add_rows(GELENK_M, &input[(GELENK_N + i) * GELENK_M], row, input);
        affine[GELENK_N + i] += gelenk_dot_product(GELENK_N, row, affine);
    }
}

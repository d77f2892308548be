
// Converts the derivatives of a step along small motions to derivatives of d_next = y_next (-) y_ref_next
// with respect to d, to the entries of both references, to the inputs, and to others. The blocks of the
// positions are first in by_x.
static void gelenk_casadi_step_about(const double *y_ref_next, const double *unit_next, const double *y_next, const double *by_d,
    const double *by_ref, double *by_x, double *by_u, double *by_y_ref, double *by_y_ref_next, int others, double *by_others)
{
    enum { N = GELENK_N, NY = GELENK_NY, BLOCK = GELENK_N * GELENK_N };
    double d_next[N], back[BLOCK], product[BLOCK];
    gelenk_difference(unit_next, y_next, d_next);
    gelenk_about_rates(d_next, d_next, 1, NULL, NULL, back);
    gelenk_about_rows(back, N, by_x);
    gelenk_about_rows(back, N, &by_x[BLOCK]);
    gelenk_about_rows(back, GELENK_M, by_u);
    gelenk_about_rows(back, others, by_others);
    for (int half = 0; half < 2; ++half) {
        double *by_y = &by_x[2 * half * BLOCK];
        gelenk_about_blocks(N, by_y, by_ref, NY, &by_y_ref[half * N * NY]);
        gelenk_about_blocks(N, by_y, by_d, N, product);
        memcpy(by_y, product, sizeof product);
    }
    // The displacement from a reference decreases by the motion of the reference, so this derivative is
    // negative.
    gelenk_casadi_tangents(y_ref_next, unit_next, d_next, product, by_y_ref_next);
    gelenk_about_rows(back, NY, by_y_ref_next);
    for (int i = 0; i < N * NY; ++i)
        by_y_ref_next[i] = -by_y_ref_next[i];
}

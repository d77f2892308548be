
/// The state x after a period with constant inputs u. Arguments: x, u. Result: x.
int gelenk_acados_step(void **in, void **out, void *params)
{
    enum { N = GELENK_N, NY = GELENK_NY };
    const double *p = (const double *)params, *y_ref = &p[1], *y_ref_next = &p[1 + NY];
    double x[2 * N], u[GELENK_M], y[NY], y_next[NY], next[2 * N];
    // parameters
    gelenk_acados_read(in[0], 2 * N, x);
    gelenk_acados_read(in[1], GELENK_M, u);
    gelenk_integrate(y_ref, x, y);
    gelenk_step(y, &x[N], u, p[0], &parameters, y_next, &next[N]);
    gelenk_difference(y_ref_next, y_next, next);
    gelenk_acados_write(next, 2 * N, out[0]);
    return 0;
}

/// The state x after a period with constant inputs u, and its derivatives with respect to u and x. Arguments:
/// x, u. Results: x, and the transposed Jacobian.
int gelenk_acados_step_derivatives(void **in, void **out, void *params)
{
    enum { N = GELENK_N, NY = GELENK_NY, M = GELENK_M, BLOCK = GELENK_N * GELENK_N };
    const double *p = (const double *)params, *y_ref = &p[1], *y_ref_next = &p[1 + NY];
    double x[2 * N], u[M], y[NY], y_next[NY], next[2 * N], by_x[4 * BLOCK], by_u[2 * N * M];
    double by_y[BLOCK], by_d[BLOCK], back[BLOCK], product[BLOCK];
    const struct blasfeo_dmat_args *to = (const struct blasfeo_dmat_args *)out[1];
    // parameters
    gelenk_acados_read(in[0], 2 * N, x);
    gelenk_acados_read(in[1], M, u);
    gelenk_integrate(y_ref, x, y);
    gelenk_integrate_derivatives(y_ref, x, by_y, by_d);
    gelenk_step_derivatives(y, &x[N], u, p[0], &parameters, y_next, &next[N], by_x, by_u);
    gelenk_difference(y_ref_next, y_next, next);
    gelenk_acados_write(next, 2 * N, out[0]);
    gelenk_about_rates(next, next, 1, NULL, NULL, back);
    // by_x has blocks of N x N entries. The blocks of the positions are first.
    gelenk_about_rows(back, N, by_x);
    gelenk_about_rows(back, N, &by_x[BLOCK]);
    gelenk_about_rows(back, M, by_u);
    for (int half = 0; half < 2; ++half) {
        gelenk_about_blocks(N, &by_x[2 * half * BLOCK], by_d, N, product);
        memcpy(&by_x[2 * half * BLOCK], product, sizeof product);
    }
    for (int row = 0; row < 2 * N; ++row) {
        for (int input = 0; input < M; ++input)
            BLASFEO_DMATEL(to->A, to->ai + input, to->aj + row) = by_u[row * M + input];
        const double *blocks = &by_x[row / N * 2 * BLOCK + row % N * N];
        for (int entry = 0; entry < 2 * N; ++entry)
            BLASFEO_DMATEL(to->A, to->ai + M + entry, to->aj + row) = blocks[entry / N * BLOCK + entry % N];
    }
    return 0;
}

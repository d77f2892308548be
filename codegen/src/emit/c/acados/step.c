
/// The state x after a period with constant inputs u. Arguments: x, u. Result: x.
int gelenk_acados_step(void **in, void **out, void *params)
{
    const double *p = (const double *)params;
    double x[2 * GELENK_N], u[GELENK_M], next[2 * GELENK_N];
    // parameters
    gelenk_acados_read(in[0], 2 * GELENK_N, x);
    gelenk_acados_read(in[1], GELENK_M, u);
    gelenk_step(x, &x[GELENK_N], u, p[0], &parameters, next, &next[GELENK_N]);
    gelenk_acados_write(next, 2 * GELENK_N, out[0]);
    return 0;
}

/// The state x after a period with constant inputs u, and its derivatives with respect to u and x. Arguments:
/// x, u. Results: x, and the transposed Jacobian.
int gelenk_acados_step_derivatives(void **in, void **out, void *params)
{
    enum { N = GELENK_N, M = GELENK_M };
    const double *p = (const double *)params;
    double x[2 * N], u[M], next[2 * N], by_x[4 * N * N], by_u[2 * N * M];
    const struct blasfeo_dmat_args *to = (const struct blasfeo_dmat_args *)out[1];
    // parameters
    gelenk_acados_read(in[0], 2 * N, x);
    gelenk_acados_read(in[1], M, u);
    gelenk_step_derivatives(x, &x[N], u, p[0], &parameters, next, &next[N], by_x, by_u);
    gelenk_acados_write(next, 2 * N, out[0]);
    for (int row = 0; row < 2 * N; ++row) {
        for (int input = 0; input < M; ++input)
            BLASFEO_DMATEL(to->A, to->ai + input, to->aj + row) = by_u[row * M + input];
        // by_x has blocks of N x N entries. The blocks of the positions are first.
        const double *blocks = &by_x[row / N * 2 * N * N + row % N * N];
        for (int entry = 0; entry < 2 * N; ++entry)
            BLASFEO_DMATEL(to->A, to->ai + M + entry, to->aj + row) = blocks[entry / N * N * N + entry % N];
    }
    return 0;
}

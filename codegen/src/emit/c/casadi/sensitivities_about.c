
// Adds the product of a matrix with N x N entries and a matrix with N x `columns` entries.
static void gelenk_casadi_add(const double *a, int columns, const double *b, double *sum)
{
    for (int i = 0; i < GELENK_N; ++i)
        for (int k = 0; k < GELENK_N; ++k)
            for (int q = 0; q < columns; ++q)
                sum[i * columns + q] += a[i * GELENK_N + k] * b[k * columns + q];
}

static void gelenk_casadi_sensitivities(const double *y, const double *v, const double *u, double period,
    const gelenk_parameters *p, double *d)
{
    enum { N = GELENK_N, M = GELENK_M, P = P_COUNT, Q = 1 + P, STEPS = S_COUNT };
    static const double parts[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0, 2.0, 2.0, 1.0};
    const double h = period / STEPS;
    // In each array, the displacements within a step (or their rates) are first, then the velocities (or the
    // accelerations).
    double y_at[GELENK_NY], reached[GELENK_NY], v_at[N], z[2 * N], slope[2 * N], sum[2 * N];
    double dz[2 * N * Q], dslope[2 * N * Q], dsum[2 * N * Q], moved[N * Q];
    double by_y[N * N], by_v[N * N], by_u[N * M + 1], c[N], drift[N * N], by_p[N * P + 1] = {0.0};
    double by_start[N * N], by_way[N * N], rate_by_way[N * N], rate_by_v[N * N];
    memcpy(y_at, y, sizeof y_at);
    memcpy(v_at, v, sizeof v_at);
    memset(d, 0, sizeof dz);
    for (int step = 0; step < STEPS; ++step) {
        memset(slope, 0, sizeof slope);
        memset(dslope, 0, sizeof dslope);
        memset(sum, 0, sizeof sum);
        memset(dsum, 0, sizeof dsum);
        for (int stage = 0; stage < 5; ++stage) {
            // The fifth stage is the end of the step.
            const double part = stage < 4 ? parts[stage] : 1.0 / 6.0;
            const double *value = stage < 4 ? slope : sum, *derivative = stage < 4 ? dslope : dsum;
            for (int i = 0; i < 2 * N; ++i) {
                z[i] = (i < N ? 0.0 : v_at[i - N]) + part * h * value[i];
                for (int q = 0; q < Q; ++q)
                    dz[i * Q + q] = (i < N ? 0.0 : d[i * Q + q]) + part * h * derivative[i * Q + q];
                dz[i * Q] += part / STEPS * value[i];
            }
            gelenk_integrate(y_at, z, reached);
            gelenk_integrate_derivatives(y_at, z, by_start, by_way);
            memset(moved, 0, sizeof moved);
            gelenk_casadi_add(by_start, Q, d, moved);
            gelenk_casadi_add(by_way, Q, dz, moved);
            if (stage == 4)
                break;
            gelenk_about_rates(z, &z[N], 0, slope, rate_by_way, rate_by_v);
            gelenk_linearize(reached, &z[N], u, p, by_y, by_v, by_u, c, drift);
            gelenk_forward_dynamics(reached, &z[N], u, p, &slope[N]);
// by_parameters
            memset(dslope, 0, sizeof dslope);
            for (int i = 0; i < N; ++i)
                for (int q = 1; q < Q; ++q)
                    dslope[(N + i) * Q + q] = by_p[i * P + q - 1];
            gelenk_casadi_add(rate_by_way, Q, dz, dslope);
            gelenk_casadi_add(rate_by_v, Q, &dz[N * Q], dslope);
            gelenk_casadi_add(by_y, Q, moved, &dslope[N * Q]);
            gelenk_casadi_add(by_v, Q, &dz[N * Q], &dslope[N * Q]);
            for (int i = 0; i < 2 * N; ++i) {
                sum[i] += weights[stage] * slope[i];
                for (int q = 0; q < Q; ++q)
                    dsum[i * Q + q] += weights[stage] * dslope[i * Q + q];
            }
        }
        memcpy(y_at, reached, sizeof y_at);
        memcpy(v_at, &z[N], sizeof v_at);
        memcpy(d, moved, sizeof moved);
        memcpy(&d[N * Q], &dz[N * Q], N * Q * sizeof *d);
    }
}

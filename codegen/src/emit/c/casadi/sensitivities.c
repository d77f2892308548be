
static void gelenk_casadi_sensitivities(
    const double *y, const double *v, const double *u, double period, const gelenk_parameters *p, double *d)
{
    enum { N = GELENK_N, M = GELENK_M, P = P_COUNT, Q = 1 + P, STEPS = S_COUNT };
    static const double parts[4] = {0.0, 0.5, 0.5, 1.0}, weights[4] = {1.0, 2.0, 2.0, 1.0};
    const double h = period / STEPS;
    double state[2 * N], z[2 * N], slope[2 * N], sum[2 * N];
    double dz[2 * N * Q], dslope[2 * N * Q], dsum[2 * N * Q];
    double by_y[N * N], by_v[N * N], by_u[N * M + 1], c[N], by_p[N * P + 1] = {0.0};
    memcpy(state, y, N * sizeof *y);
    memcpy(&state[N], v, N * sizeof *v);
    memset(d, 0, sizeof dz);
    for (int step = 0; step < STEPS; ++step) {
        memset(slope, 0, sizeof slope);
        memset(dslope, 0, sizeof dslope);
        memset(sum, 0, sizeof sum);
        memset(dsum, 0, sizeof dsum);
        for (int stage = 0; stage < 4; ++stage) {
            for (int i = 0; i < 2 * N; ++i) {
                z[i] = state[i] + parts[stage] * h * slope[i];
                for (int q = 0; q < Q; ++q)
                    dz[i * Q + q] = d[i * Q + q] + parts[stage] * h * dslope[i * Q + q];
                dz[i * Q] += parts[stage] / STEPS * slope[i];
            }
            gelenk_linearize(z, &z[N], u, p, by_y, by_v, by_u, c);
// by_parameters
            memcpy(slope, &z[N], N * sizeof *slope);
            gelenk_forward_dynamics(z, &z[N], u, p, &slope[N]);
            for (int i = 0; i < N; ++i)
                for (int q = 0; q < Q; ++q) {
                    double rate = q > 0 ? by_p[i * P + q - 1] : 0.0;
                    for (int j = 0; j < N; ++j)
                        rate += by_y[i * N + j] * dz[j * Q + q] + by_v[i * N + j] * dz[(N + j) * Q + q];
                    dslope[i * Q + q] = dz[(N + i) * Q + q];
                    dslope[(N + i) * Q + q] = rate;
                }
            for (int i = 0; i < 2 * N; ++i) {
                sum[i] += weights[stage] * slope[i];
                for (int q = 0; q < Q; ++q)
                    dsum[i * Q + q] += weights[stage] * dslope[i * Q + q];
            }
        }
        for (int i = 0; i < 2 * N; ++i) {
            state[i] += h / 6.0 * sum[i];
            for (int q = 0; q < Q; ++q)
                d[i * Q + q] += h / 6.0 * dsum[i * Q + q];
            d[i * Q] += sum[i] / (6.0 * STEPS);
        }
    }
}

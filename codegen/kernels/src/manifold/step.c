{
    const double h = period / (double)GELENK_SUBSTEPS;
    const double zero[GELENK_N] = {0.0};
    double a1[GELENK_N], a2[GELENK_N], a3[GELENK_N], a4[GELENK_N], v2[GELENK_N], v3[GELENK_N], v4[GELENK_N];
    double d[GELENK_N], r2[GELENK_N], r3[GELENK_N], r4[GELENK_N], reached[GELENK_NY];
    memcpy(y_next, y, sizeof reached);
    memcpy(v_next, v, sizeof v2);
    for (int k = 0; k < GELENK_SUBSTEPS; ++k) {
        gelenk_forward_dynamics(y_next, v_next, u, p, a1);
        gelenk_advance(GELENK_N, d, zero, h / 2.0, v_next);
        gelenk_advance(GELENK_N, v2, v_next, h / 2.0, a1);
        gelenk_displacement_rate(d, v2, r2);
        gelenk_integrate(y_next, d, reached);
        gelenk_forward_dynamics(reached, v2, u, p, a2);
        gelenk_advance(GELENK_N, d, zero, h / 2.0, r2);
        gelenk_advance(GELENK_N, v3, v_next, h / 2.0, a2);
        gelenk_displacement_rate(d, v3, r3);
        gelenk_integrate(y_next, d, reached);
        gelenk_forward_dynamics(reached, v3, u, p, a3);
        gelenk_advance(GELENK_N, d, zero, h, r3);
        gelenk_advance(GELENK_N, v4, v_next, h, a3);
        gelenk_displacement_rate(d, v4, r4);
        gelenk_integrate(y_next, d, reached);
        gelenk_forward_dynamics(reached, v4, u, p, a4);
        memcpy(d, zero, sizeof d);
        gelenk_add_rates(GELENK_N, d, h, v_next, r2, r3, r4);
        gelenk_add_rates(GELENK_N, v_next, h, a1, a2, a3, a4);
        gelenk_integrate(y_next, d, reached);
        memcpy(y_next, reached, sizeof reached);
    }
}

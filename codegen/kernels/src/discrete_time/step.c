{
    const double h = period / (double)GELENK_SUBSTEPS;
    double a1[GELENK_N], a2[GELENK_N], a3[GELENK_N], a4[GELENK_N];
    double y2[GELENK_N], y3[GELENK_N], y4[GELENK_N], v2[GELENK_N], v3[GELENK_N], v4[GELENK_N];
    memcpy(y_next, y, sizeof y2);
    memcpy(v_next, v, sizeof v2);
    for (int k = 0; k < GELENK_SUBSTEPS; ++k) {
        gelenk_forward_dynamics(y_next, v_next, u, p, a1);
        gelenk_advance(GELENK_N, y2, y_next, h / 2.0, v_next);
        gelenk_advance(GELENK_N, v2, v_next, h / 2.0, a1);
        gelenk_forward_dynamics(y2, v2, u, p, a2);
        gelenk_advance(GELENK_N, y3, y_next, h / 2.0, v2);
        gelenk_advance(GELENK_N, v3, v_next, h / 2.0, a2);
        gelenk_forward_dynamics(y3, v3, u, p, a3);
        gelenk_advance(GELENK_N, y4, y_next, h, v3);
        gelenk_advance(GELENK_N, v4, v_next, h, a3);
        gelenk_forward_dynamics(y4, v4, u, p, a4);
        gelenk_add_rates(GELENK_N, y_next, h, v_next, v2, v3, v4);
        gelenk_add_rates(GELENK_N, v_next, h, a1, a2, a3, a4);
    }
}

{
    const double h = period / (double)GELENK_SUBSTEPS;
    const gelenk_motion zero = {{0.0}, {0.0}, {0.0}};
    gelenk_motion moved = gelenk_initial_motion(zero.value, 0), v1 = gelenk_initial_motion(v, 1);
    gelenk_motion d, v2, v3, v4, r2, r3, r4, a1, a2, a3, a4;
    double reached[GELENK_NY];
    memcpy(y_next, y, sizeof reached);
    for (int k = 0; k < GELENK_SUBSTEPS; ++k) {
        gelenk_acceleration_motion(y_next, &moved, &v1, u, p, &a1);
        gelenk_advance_motion(&d, &zero, h / 2.0, &v1);
        gelenk_advance_motion(&v2, &v1, h / 2.0, &a1);
        gelenk_rates_in_chart(y_next, &moved, &d, &v2, u, p, &r2, &a2);
        gelenk_advance_motion(&d, &zero, h / 2.0, &r2);
        gelenk_advance_motion(&v3, &v1, h / 2.0, &a2);
        gelenk_rates_in_chart(y_next, &moved, &d, &v3, u, p, &r3, &a3);
        gelenk_advance_motion(&d, &zero, h, &r3);
        gelenk_advance_motion(&v4, &v1, h, &a3);
        gelenk_rates_in_chart(y_next, &moved, &d, &v4, u, p, &r4, &a4);
        d = zero;
        gelenk_add_motion_rates(&d, h, &v1, &r2, &r3, &r4);
        gelenk_add_motion_rates(&v1, h, &a1, &a2, &a3, &a4);
        gelenk_motion after;
        gelenk_moved_on(&moved, &d, &after);
        moved = after;
        gelenk_integrate(y_next, d.value, reached);
        memcpy(y_next, reached, sizeof reached);
    }
    memcpy(v_next, v1.value, sizeof v1.value);
    for (int i = 0; i < GELENK_N; ++i) {
        for (int block = 0; block < 2; ++block) {
            const size_t size = GELENK_N * sizeof *y;
            const int from = i * GELENK_ROW + block * GELENK_N;
            const int to = (block * GELENK_N + i) * GELENK_N;
            memcpy(&dx_next_dx[to], &moved.by_state[from], size);
            memcpy(&dx_next_dx[2 * GELENK_N * GELENK_N + to], &v1.by_state[from], size);
        }
    }
    memcpy(dx_next_du, moved.by_inputs, GELENK_N * GELENK_M * sizeof *y);
    memcpy(&dx_next_du[GELENK_N * GELENK_M], v1.by_inputs, GELENK_N * GELENK_M * sizeof *y);
}

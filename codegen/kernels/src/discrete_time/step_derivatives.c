{
    const double h = period / (double)GELENK_SUBSTEPS;
    gelenk_motion y1 = gelenk_initial_motion(y, 0), v1 = gelenk_initial_motion(v, 1);
    gelenk_motion y2, y3, y4, v2, v3, v4, a1, a2, a3, a4;
    for (int k = 0; k < GELENK_SUBSTEPS; ++k) {
        gelenk_acceleration_motion(&y1, &v1, u, p, &a1);
        gelenk_advance_motion(&y2, &y1, h / 2.0, &v1);
        gelenk_advance_motion(&v2, &v1, h / 2.0, &a1);
        gelenk_acceleration_motion(&y2, &v2, u, p, &a2);
        gelenk_advance_motion(&y3, &y1, h / 2.0, &v2);
        gelenk_advance_motion(&v3, &v1, h / 2.0, &a2);
        gelenk_acceleration_motion(&y3, &v3, u, p, &a3);
        gelenk_advance_motion(&y4, &y1, h, &v3);
        gelenk_advance_motion(&v4, &v1, h, &a3);
        gelenk_acceleration_motion(&y4, &v4, u, p, &a4);
        gelenk_add_motion_rates(&y1, h, &v1, &v2, &v3, &v4);
        gelenk_add_motion_rates(&v1, h, &a1, &a2, &a3, &a4);
    }
    memcpy(y_next, y1.value, sizeof y1.value);
    memcpy(v_next, v1.value, sizeof v1.value);
    for (int i = 0; i < GELENK_N; ++i) {
        for (int block = 0; block < 2; ++block) {
            const size_t size = GELENK_N * sizeof *y;
            const int from = i * GELENK_ROW + block * GELENK_N;
            const int to = (block * GELENK_N + i) * GELENK_N;
            memcpy(&dx_next_dx[to], &y1.by_state[from], size);
            memcpy(&dx_next_dx[2 * GELENK_N * GELENK_N + to], &v1.by_state[from], size);
        }
    }
    memcpy(dx_next_du, y1.by_inputs, GELENK_N * GELENK_M * sizeof *y);
    memcpy(&dx_next_du[GELENK_N * GELENK_M], v1.by_inputs, GELENK_N * GELENK_M * sizeof *y);
}

{
    double by_y[GELENK_N * GELENK_N], by_v[GELENK_N * GELENK_N], by_u[GELENK_BY_INPUTS], remainder[GELENK_N];
    double drift[GELENK_N * GELENK_N];
    gelenk_linearize(y, v, u, p, by_y, by_v, by_u, remainder, drift);
    gelenk_zero_order_hold_on_manifold(by_y, by_v, by_u, remainder, drift, period, a_d, b_d, c_d);
}

{
    double by_y[GELENK_N * GELENK_N], by_v[GELENK_N * GELENK_N], by_u[GELENK_BY_INPUTS], remainder[GELENK_N];
    gelenk_linearize(y, v, u, p, by_y, by_v, by_u, remainder);
    gelenk_zero_order_hold(by_y, by_v, by_u, remainder, period, a_d, b_d, c_d);
}

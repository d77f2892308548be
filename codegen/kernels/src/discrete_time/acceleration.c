// The acceleration with its derivatives.
static void gelenk_acceleration_motion(const gelenk_motion *y, const gelenk_motion *v, const double *u,
    const gelenk_parameters *p, gelenk_motion *a)
{
    double by_y[GELENK_N * GELENK_N], by_v[GELENK_N * GELENK_N];
    gelenk_linearize(y->value, v->value, u, p, by_y, by_v, a->by_inputs, a->value);
    gelenk_add_chain_rule(by_y, by_v, y, v, u, a);
}

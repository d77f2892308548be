// Adds the product of a joint's block and the derivatives of a motion.
static void gelenk_add_block(int size, const double *block, const gelenk_motion *motion, int first, gelenk_motion *sum)
{
    for (int i = 0; i < size; ++i) {
        for (int k = 0; k < size; ++k) {
            const double factor = block[i * size + k];
            const int to = first + i, from = first + k;
            gelenk_add_scaled(GELENK_ROW, &sum->by_state[to * GELENK_ROW], factor, &motion->by_state[from * GELENK_ROW]);
            gelenk_add_scaled(GELENK_M, &sum->by_inputs[to * GELENK_M], factor, &motion->by_inputs[from * GELENK_M]);
        }
    }
}

// The derivatives of y (+) d from the derivatives of y and d. The value of the result is 0, because the
// affine remainder refers to the displacement 0.
static void gelenk_moved_on(const gelenk_motion *y, const gelenk_motion *d, gelenk_motion *sum)
{
    const gelenk_motion zero = {{0.0}, {0.0}, {0.0}};
    *sum = zero;
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint];
        double by_y[36] = {0.0}, by_d[36] = {0.0};
        const int size = gelenk_joint_tangents(joint, d->value, by_y, by_d);
        gelenk_add_block(size, by_y, y, first, sum);
        gelenk_add_block(size, by_d, d, first, sum);
    }
}

// The derivatives of v + 1/2 [d, v] + 1/12 [d, [d, v]] with respect to d and v.
static void gelenk_chart_rates(int size, const double *d, const double *v, double *by_d, double *by_v)
{
    double once[6] = {0.0};
    gelenk_bracket(size, d, v, once);
    for (int j = 0; j < size; ++j) {
        double unit[6] = {0.0}, changed[6] = {0.0}, outer[6] = {0.0}, deeper[6] = {0.0}, column[6] = {0.0};
        unit[j] = 1.0;
        gelenk_bracket(size, unit, v, changed);
        gelenk_bracket(size, unit, once, outer);
        gelenk_bracket(size, d, changed, deeper);
        gelenk_chart_rate(size, d, unit, column);
        for (int i = 0; i < size; ++i) {
            by_d[i * size + j] = changed[i] / 2.0 + (outer[i] + deeper[i]) / 12.0;
            by_v[i * size + j] = column[i];
        }
    }
}

// The rate of the displacement with its derivatives.
static void gelenk_displacement_rates(const gelenk_motion *d, const gelenk_motion *v, gelenk_motion *rate)
{
    const gelenk_motion zero = {{0.0}, {0.0}, {0.0}};
    *rate = zero;
    gelenk_displacement_rate(d->value, v->value, rate->value);
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint];
        const int entries = GELENK_JOINT_POSITIONS[joint];
        const int size = entries > 1 ? entries - 1 : 1;
        double by_d[36] = {0.0}, by_v[36] = {1.0};
        if (size > 1) {
            gelenk_chart_rates(size, &d->value[first], &v->value[first], by_d, by_v);
        }
        gelenk_add_block(size, by_d, d, first, rate);
        gelenk_add_block(size, by_v, v, first, rate);
    }
}

// The acceleration at the positions y, by the chain rule. Only the derivatives in `moved` are used.
static void gelenk_acceleration_motion(const double *y, const gelenk_motion *moved, const gelenk_motion *v,
    const double *u, const gelenk_parameters *p, gelenk_motion *a)
{
    double by_y[GELENK_N * GELENK_N], by_v[GELENK_N * GELENK_N], drift[GELENK_N * GELENK_N];
    gelenk_linearize(y, v->value, u, p, by_y, by_v, a->by_inputs, a->value, drift);
    gelenk_add_chain_rule(by_y, by_v, moved, v, u, a);
}

// The rate of the displacement d from y, and the acceleration there.
static void gelenk_rates_in_chart(const double *y, const gelenk_motion *moved, const gelenk_motion *d,
    const gelenk_motion *v, const double *u, const gelenk_parameters *p, gelenk_motion *rate, gelenk_motion *a)
{
    double reached[GELENK_NY];
    gelenk_motion position;
    gelenk_integrate(y, d->value, reached);
    gelenk_moved_on(moved, d, &position);
    gelenk_displacement_rates(d, v, rate);
    gelenk_acceleration_motion(reached, &position, v, u, p, a);
}

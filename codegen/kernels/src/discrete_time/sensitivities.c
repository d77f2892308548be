// Coordinates, velocities or accelerations, with their derivatives with respect to the initial state and to
// the inputs.
typedef struct {
    double value[GELENK_N];
    double by_state[GELENK_HALF];
    double by_inputs[GELENK_BY_INPUTS];
} gelenk_motion;

// Sets coordinates (block 0) or velocities (block 1) of the initial state.
static gelenk_motion gelenk_initial_motion(const double *value, int block)
{
    gelenk_motion motion = {{0.0}, {0.0}, {0.0}};
    memcpy(motion.value, value, sizeof motion.value);
    for (int i = 0; i < GELENK_N; ++i) {
        motion.by_state[i * GELENK_ROW + block * GELENK_N + i] = 1.0;
    }
    return motion;
}

// sum = a + factor b
static void gelenk_advance_motion(gelenk_motion *sum, const gelenk_motion *a, double factor, const gelenk_motion *b)
{
    gelenk_advance(GELENK_N, sum->value, a->value, factor, b->value);
    gelenk_advance(GELENK_HALF, sum->by_state, a->by_state, factor, b->by_state);
    gelenk_advance(GELENK_N * GELENK_M, sum->by_inputs, a->by_inputs, factor, b->by_inputs);
}

static void gelenk_add_motion_rates(gelenk_motion *y, double h, const gelenk_motion *k1, const gelenk_motion *k2,
    const gelenk_motion *k3, const gelenk_motion *k4)
{
    gelenk_add_rates(GELENK_N, y->value, h, k1->value, k2->value, k3->value, k4->value);
    gelenk_add_rates(GELENK_HALF, y->by_state, h, k1->by_state, k2->by_state, k3->by_state, k4->by_state);
    gelenk_add_rates(
        GELENK_N * GELENK_M, y->by_inputs, h, k1->by_inputs, k2->by_inputs, k3->by_inputs, k4->by_inputs);
}

// Computes the acceleration a with its derivatives by the chain rule. Initially, a contains the affine
// remainder and the derivatives with respect to the inputs.
static void gelenk_add_chain_rule(const double *by_y, const double *by_v, const gelenk_motion *y,
    const gelenk_motion *v, const double *u, gelenk_motion *a)
{
    double by_u[GELENK_BY_INPUTS];
    memcpy(by_u, a->by_inputs, sizeof by_u);
    for (int i = 0; i < GELENK_HALF; ++i) {
        a->by_state[i] = 0.0;
    }
    for (int i = 0; i < GELENK_N; ++i) {
        const double *row_y = &by_y[i * GELENK_N];
        const double *row_v = &by_v[i * GELENK_N];
        a->value[i] += gelenk_dot_product(GELENK_N, row_y, y->value) + gelenk_dot_product(GELENK_N, row_v, v->value)
            + gelenk_dot_product(GELENK_M, &by_u[i * GELENK_M], u);
        gelenk_add_row(&a->by_state[i * GELENK_ROW], row_y, y->by_state);
        gelenk_add_row(&a->by_state[i * GELENK_ROW], row_v, v->by_state);
        gelenk_add_combination(&a->by_inputs[i * GELENK_M], row_y, y->by_inputs);
        gelenk_add_combination(&a->by_inputs[i * GELENK_M], row_v, v->by_inputs);
    }
}

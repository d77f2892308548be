// The Lie bracket ad_a b of so(3) (3 entries) or se(3) (6 entries).
static inline void gelenk_bracket(int size, const double *a, const double *b, double *result)
{
    if (size == 3) {
        gelenk_cross(a, b, result);
        return;
    }
    double one[3], other[3];
    gelenk_cross(&a[3], b, one);
    gelenk_cross(a, &b[3], other);
    for (int i = 0; i < 3; ++i) {
        result[i] = one[i] + other[i];
    }
    gelenk_cross(&a[3], &b[3], &result[3]);
}

// v + 1/2 [d, v] + 1/12 [d, [d, v]]
static inline void gelenk_chart_rate(int size, const double *d, const double *v, double *rate)
{
    double once[6] = {0.0}, twice[6] = {0.0};
    gelenk_bracket(size, d, v, once);
    gelenk_bracket(size, d, once, twice);
    for (int i = 0; i < size; ++i) {
        rate[i] = v[i] + (once[i] / 2.0 + twice[i] / 12.0);
    }
}

// The rate of the displacement d from a fixed position. Steps are computed by the method of Munthe-Kaas (High
// order Runge-Kutta methods on manifolds, 1999), that is by the classical Runge-Kutta method for d in y (+)
// d. The neglected terms have order 5 in the step length.
static void gelenk_displacement_rate(const double *d, const double *v, double *rate)
{
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint];
        if (GELENK_JOINT_POSITIONS[joint] == 7) {
            gelenk_chart_rate(6, &d[first], &v[first], &rate[first]);
        } else if (GELENK_JOINT_POSITIONS[joint] == 4) {
            gelenk_chart_rate(3, &d[first], &v[first], &rate[first]);
        } else {
            rate[first] = v[first];
        }
    }
}

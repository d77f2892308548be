
#ifndef GELENK_ABOUT_RATES
#define GELENK_ABOUT_RATES
// 1/x^2 - cot x / x and its first two derivatives with respect to z = x^2; NaN for x >= pi, because x = pi is
// a pole.
//
// The value is the sum of 2 / (k^2 pi^2 - z). The first two terms are computed exactly, the others by a power
// series.
static void gelenk_about_cotangent(double z, double *f)
{
    static const double series[18] = {
        0.0800303742274889, 0.0004070099310180099, 3.5741237699164256e-06, 3.606589843138828e-08, 3.846877389020977e-10,
        4.210739353747645e-12, 4.669476256503875e-14, 5.213765901169357e-16, 5.8430132441676545e-18, 6.561434069427314e-20,
        7.376409405333304e-22, 8.297754258406324e-24, 9.337411097079854e-26, 1.0509366892190242e-27, 1.182970241993779e-29,
        1.3316729461007125e-31, 1.4991193674975246e-33, 1.6876532362695565e-35,
    };
    static const double poles[2] = {9.869604401089358, 39.47841760435743};
    double value = 0.0, slope = 0.0, bend = 0.0;
    for (int j = 17; j >= 0; --j) {
        bend = 2.0 * slope + z * bend;
        slope = value + z * slope;
        value = series[j] + z * value;
    }
    for (int k = 0; k < 2; ++k) {
        const double near = 1.0 / (poles[k] - z);
        value += 2.0 * near;
        slope += 2.0 * near * near;
        bend += 4.0 * near * near * near;
    }
    f[0] = z < poles[0] ? value : NAN;
    f[1] = slope;
    f[2] = bend;
}

// The Lie bracket of two velocities (linear, angular).
static void gelenk_about_bracket(const double *a, const double *b, double *c)
{
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        c[i] = a[3 + j] * b[k] - a[3 + k] * b[j] + a[j] * b[3 + k] - a[k] * b[3 + j];
        c[3 + i] = a[3 + j] * b[3 + k] - a[3 + k] * b[3 + j];
    }
}

// The rate of d at the velocity v: v + 1/2 [d, v] + b [d, [d, v]]. The factor b is given with its
// derivatives. It is a function of the square of the angle. Its change along the linear part of d is the dual
// part of the factor.
static void gelenk_about_rate(const double *d, const double *b, const double *v, double *rate)
{
    double once[6], twice[6];
    gelenk_about_bracket(d, v, once);
    gelenk_about_bracket(d, once, twice);
    const double dual = 2.0 * (d[0] * d[3] + d[1] * d[4] + d[2] * d[5]) * b[1];
    for (int i = 0; i < 6; ++i)
        rate[i] = v[i] + (0.5 * once[i] + b[0] * twice[i]);
    for (int i = 0; i < 3; ++i)
        rate[i] += dual * twice[3 + i];
}

// The derivative of this rate with respect to one entry of d.
static void gelenk_about_rate_by(const double *d, const double *b, const double *v, int entry, double *column)
{
    double e[6] = {0.0}, once[6], twice[6], by_once[6], outer[6], inner[6];
    e[entry] = 1.0;
    gelenk_about_bracket(d, v, once);
    gelenk_about_bracket(d, once, twice);
    gelenk_about_bracket(e, v, by_once);
    gelenk_about_bracket(e, once, outer);
    gelenk_about_bracket(d, by_once, inner);
    const double along = 2.0 * (d[0] * d[3] + d[1] * d[4] + d[2] * d[5]);
    const double square = entry < 3 ? 0.0 : 2.0 * d[entry], mixed = 2.0 * d[entry < 3 ? entry + 3 : entry - 3];
    for (int i = 0; i < 6; ++i)
        column[i] = 0.5 * by_once[i] + b[0] * (outer[i] + inner[i]) + b[1] * square * twice[i];
    for (int i = 0; i < 3; ++i)
        column[i] += along * b[1] * (outer[3 + i] + inner[3 + i]) + (mixed * b[1] + along * b[2] * square) * twice[3 + i];
}

// The rate of d in y (+) d at the velocity v, and its N x N derivatives with respect to d and v. Null
// pointers are not written to.
//
// The rate is exact, or it is the rate in the Runge-Kutta steps, which have the factor b = 1/12.
static void gelenk_about_rates(
    const double *d, const double *v, int is_exact, double *rate, double *by_d, double *by_v)
{
    for (int i = 0; i < GELENK_N * GELENK_N; ++i) {
        if (by_d)
            by_d[i] = 0.0;
        if (by_v)
            by_v[i] = 0.0;
    }
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int first = GELENK_FIRST_VELOCITIES[joint], entries = GELENK_JOINT_POSITIONS[joint];
        if (entries == 1) {
            if (rate)
                rate[first] = v[first];
            if (by_v)
                by_v[first * (GELENK_N + 1)] = 1.0;
            continue;
        }
        // A spherical joint has no linear part.
        const int skipped = entries == 7 ? 0 : 3;
        double own[6] = {0.0}, moving[6] = {0.0}, column[6], b[3] = {1.0 / 12.0, 0.0, 0.0};
        memcpy(&own[skipped], &d[first], (6 - skipped) * sizeof *own);
        memcpy(&moving[skipped], &v[first], (6 - skipped) * sizeof *own);
        if (is_exact) {
            // The function has half the angle as argument, whose square is a quarter of the square of the
            // angle.
            gelenk_about_cotangent(0.25 * (own[3] * own[3] + own[4] * own[4] + own[5] * own[5]), b);
            b[0] /= 4.0;
            b[1] /= 16.0;
            b[2] /= 64.0;
        }
        if (rate) {
            gelenk_about_rate(own, b, moving, column);
            memcpy(&rate[first], &column[skipped], (6 - skipped) * sizeof *rate);
        }
        for (int j = skipped; j < 6; ++j) {
            double unit[6] = {0.0}, by_unit[6];
            unit[j] = 1.0;
            gelenk_about_rate_by(own, b, moving, j, column);
            gelenk_about_rate(own, b, unit, by_unit);
            for (int i = skipped; i < 6; ++i) {
                const int to = (first + i - skipped) * GELENK_N + first + j - skipped;
                if (by_d)
                    by_d[to] = column[i];
                if (by_v)
                    by_v[to] = by_unit[i];
            }
        }
    }
}
#endif

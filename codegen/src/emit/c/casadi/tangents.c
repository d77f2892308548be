
// The small motion per unit of each entry of a quaternion q: 3 rows of NY entries. `unit` is the normalized
// quaternion.
static void gelenk_casadi_attitude(const double *q, const double *unit, double *rows)
{
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double s = 2.0 / length, x = s * unit[0], y = s * unit[1], z = s * unit[2], w = s * unit[3];
    const double turn[3][4] = {{w, z, -y, -x}, {-z, w, x, -y}, {y, -x, w, -z}};
    for (int i = 0; i < 3; ++i)
        memcpy(&rows[i * GELENK_NY], turn[i], sizeof turn[i]);
}

// The small motion per unit of each entry of the positions y: N x NY. The quaternions of y are normalized to
// `unit`.
static void gelenk_casadi_entries(const double *y, const double *unit, double *matrix)
{
    memset(matrix, 0, GELENK_N * GELENK_NY * sizeof *matrix);
    for (int joint = 0; joint < GELENK_JOINTS; ++joint) {
        const int entries = GELENK_JOINT_POSITIONS[joint], from = GELENK_FIRST_POSITIONS[joint];
        double *block = &matrix[GELENK_FIRST_VELOCITIES[joint] * GELENK_NY + from];
        if (entries == 1) {
            *block = 1.0;
            continue;
        }
        const double *q = &unit[from + entries - 4];
        const int turning = entries == 7 ? 3 : 0;
        gelenk_casadi_attitude(&y[from + entries - 4], q, &block[turning * (GELENK_NY + 1)]);
        // The inverse rotation transforms the translation to the axes of the body.
        for (int i = 0; i < turning; ++i)
            for (int j = 0; j < 3; ++j) {
                const double inner = i == j ? q[3] * q[3] - q[0] * q[0] - q[1] * q[1] - q[2] * q[2] : 0.0;
                const double outer = i == j ? 0.0 : (j == (i + 1) % 3 ? 2.0 : -2.0) * q[3] * q[3 - i - j];
                block[i * GELENK_NY + j] = inner + 2.0 * q[i] * q[j] + outer;
            }
    }
}

// The derivatives of y_ref (+) d with respect to d (N x N), and with respect to the entries of y_ref (N x
// NY).
static void gelenk_casadi_tangents(const double *y_ref, const double *unit, const double *d, double *by_d, double *by_ref)
{
    double by_y[GELENK_N * GELENK_N], entries[GELENK_N * GELENK_NY];
    gelenk_integrate_derivatives(unit, d, by_y, by_d);
    gelenk_casadi_entries(y_ref, unit, entries);
    gelenk_about_blocks(GELENK_N, by_y, entries, GELENK_NY, by_ref);
}

// The function 1 + linear ad_d + square ad_d^2 of a displacement d. The slopes are the derivatives of the
// coefficients with respect to the angle theta, divided by theta.
typedef struct {
    double linear;
    double square;
    double linear_slope;
    double square_slope;
} gelenk_polynomial;

// The derivatives of X exp(d) with respect to X and d: Ad(exp(-d)), and the sum of (-ad_d)^k / (k + 1)!.
static void gelenk_tangent_polynomials(const double *w, gelenk_polynomial *by_pose, gelenk_polynomial *by_d)
{
    double half[6], c[6];
    gelenk_stumpff(0.25 * gelenk_inner(w, w), half);
    gelenk_stumpff_doubled(half, c);
    by_pose->linear = -c[1];
    by_pose->square = c[2];
    by_pose->linear_slope = c[2] - c[3];
    by_pose->square_slope = 2.0 * c[4] - c[3];
    by_d->linear = -c[2];
    by_d->square = c[3];
    by_d->linear_slope = c[3] - 2.0 * c[4];
    by_d->square_slope = 3.0 * c[5] - c[4];
}

// The matrix alpha w x + beta w x w x, 3 x 3.
static inline void gelenk_cross_matrices(double alpha, double beta, const double *w, double *matrix)
{
    const double s[3] = {alpha * w[0], alpha * w[1], alpha * w[2]};
    const double t[3] = {beta * w[0], beta * w[1], beta * w[2]};
    const double xx = t[0] * w[0], yy = t[1] * w[1], zz = t[2] * w[2];
    const double xy = t[0] * w[1], xz = t[0] * w[2], yz = t[1] * w[2];
    matrix[0] = -(yy + zz);
    matrix[1] = xy - s[2];
    matrix[2] = xz + s[1];
    matrix[3] = xy + s[2];
    matrix[4] = -(xx + zz);
    matrix[5] = yz - s[0];
    matrix[6] = xz - s[1];
    matrix[7] = yz + s[0];
    matrix[8] = -(xx + yy);
}

// The function on SO(3), 3 x 3.
static void gelenk_on_rotation(const gelenk_polynomial *polynomial, const double *w, double *matrix)
{
    gelenk_cross_matrices(polynomial->linear, polynomial->square, w, matrix);
    for (int i = 0; i < 3; ++i) {
        matrix[i * 3 + i] += 1.0;
    }
}

// The function on SE(3), 6 x 6. Since ad_d = [w x, l x; 0, w x], the upper right block is the derivative of
// the function on SO(3) in the direction l.
static void gelenk_on_pose(const gelenk_polynomial *polynomial, const double *d, double *matrix)
{
    const double *l = d, *w = &d[3];
    const double along = gelenk_inner(w, l);
    double diagonal[9], turned[9], moved[9];
    gelenk_on_rotation(polynomial, w, diagonal);
    gelenk_cross_matrices(along * polynomial->linear_slope, along * polynomial->square_slope, w, turned);
    gelenk_cross_matrices(polynomial->linear, 0.0, l, moved);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            const double mixed = polynomial->square * (l[i] * w[j] + w[i] * l[j]);
            matrix[i * 6 + j] = diagonal[i * 3 + j];
            matrix[(i + 3) * 6 + j + 3] = diagonal[i * 3 + j];
            matrix[i * 6 + j + 3] = turned[i * 3 + j] + (moved[i * 3 + j] + mixed);
            matrix[(i + 3) * 6 + j] = 0.0;
        }
        matrix[i * 6 + i + 3] -= 2.0 * polynomial->square * along;
    }
}

// The derivatives of y (+) d with respect to y and d for one joint. Returns their size: 1, 3 or 6.
static int gelenk_joint_tangents(int joint, const double *d, double *by_y, double *by_d)
{
    const double *own = &d[GELENK_FIRST_VELOCITIES[joint]];
    gelenk_polynomial pose_polynomial, d_polynomial;
    if (GELENK_JOINT_POSITIONS[joint] == 7) {
        gelenk_tangent_polynomials(&own[3], &pose_polynomial, &d_polynomial);
        gelenk_on_pose(&pose_polynomial, own, by_y);
        gelenk_on_pose(&d_polynomial, own, by_d);
        return 6;
    }
    if (GELENK_JOINT_POSITIONS[joint] == 4) {
        gelenk_tangent_polynomials(own, &pose_polynomial, &d_polynomial);
        gelenk_on_rotation(&pose_polynomial, own, by_y);
        gelenk_on_rotation(&d_polynomial, own, by_d);
        return 3;
    }
    *by_y = 1.0;
    *by_d = 1.0;
    return 1;
}

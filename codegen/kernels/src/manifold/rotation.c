// Number of terms of the sums below.
#define GELENK_STUMPFF_TERMS 10

// Factorials, rounded after each multiplication.
#define GELENK_14_FACTORIAL (6227020800.0 * 14.0)
#define GELENK_15_FACTORIAL (GELENK_14_FACTORIAL * 15.0)
#define GELENK_16_FACTORIAL (GELENK_15_FACTORIAL * 16.0)
#define GELENK_17_FACTORIAL (GELENK_16_FACTORIAL * 17.0)
#define GELENK_18_FACTORIAL (GELENK_17_FACTORIAL * 18.0)
#define GELENK_19_FACTORIAL (GELENK_18_FACTORIAL * 19.0)
#define GELENK_20_FACTORIAL (GELENK_19_FACTORIAL * 20.0)
#define GELENK_21_FACTORIAL (GELENK_20_FACTORIAL * 21.0)
#define GELENK_22_FACTORIAL (GELENK_21_FACTORIAL * 22.0)
#define GELENK_23_FACTORIAL (GELENK_22_FACTORIAL * 23.0)

// The coefficients 1/(2j + 4)! and 1/(2j + 5)!, with alternating signs.
static const double gelenk_stumpff_coefficients[GELENK_STUMPFF_TERMS][2] = {
    {1.0 / 24.0, 1.0 / 120.0},
    {-1.0 / 720.0, -1.0 / 5040.0},
    {1.0 / 40320.0, 1.0 / 362880.0},
    {-1.0 / 3628800.0, -1.0 / 39916800.0},
    {1.0 / 479001600.0, 1.0 / 6227020800.0},
    {-1.0 / GELENK_14_FACTORIAL, -1.0 / GELENK_15_FACTORIAL},
    {1.0 / GELENK_16_FACTORIAL, 1.0 / GELENK_17_FACTORIAL},
    {-1.0 / GELENK_18_FACTORIAL, -1.0 / GELENK_19_FACTORIAL},
    {1.0 / GELENK_20_FACTORIAL, 1.0 / GELENK_21_FACTORIAL},
    {-1.0 / GELENK_22_FACTORIAL, -1.0 / GELENK_23_FACTORIAL},
};

// The Stumpff functions for k = 0 to 5: the sums of (-z)^j / (2j + k)!. They are cos x, sin x / x, (1 - cos
// x) / x^2 and so on, with z = x^2.
//
// Up to x = pi/2 the sums are used, because they lose no digits there. For larger x, sine and cosine are
// used. Errors are a few units in the last place of 1/k!.
static void gelenk_stumpff(double z, double *c)
{
    if (z <= 2.5) {
        double even = 0.0, odd = 0.0;
        for (int j = GELENK_STUMPFF_TERMS - 1; j >= 0; --j) {
            even = gelenk_stumpff_coefficients[j][0] + z * even;
            odd = gelenk_stumpff_coefficients[j][1] + z * odd;
        }
        c[2] = 0.5 - z * even;
        c[3] = 1.0 / 6.0 - z * odd;
        c[0] = 1.0 - z * c[2];
        c[1] = 1.0 - z * c[3];
        c[4] = even;
        c[5] = odd;
        return;
    }
    const double x = sqrt(z);
    double sine, cosine;
    gelenk_sin_cos(x, &sine, &cosine);
    c[0] = cosine;
    c[1] = sine / x;
    c[2] = (1.0 - cosine) / z;
    c[3] = (1.0 - c[1]) / z;
    c[4] = (0.5 - c[2]) / z;
    c[5] = (1.0 / 6.0 - c[3]) / z;
}

// The Stumpff functions for k = 1 to 5 of twice the angle, at index k. No difference of nearly equal numbers
// occurs.
static void gelenk_stumpff_doubled(const double *c, double *doubled)
{
    doubled[1] = c[0] * c[1];
    doubled[2] = 0.5 * c[1] * c[1];
    doubled[3] = (c[3] + c[1] * c[2]) / 4.0;
    doubled[4] = c[3] * (1.0 + c[1]) / 8.0;
    doubled[5] = (c[5] + c[4] + c[2] * c[3]) / 16.0;
}

static inline void gelenk_cross(const double *a, const double *b, double *result)
{
    result[0] = a[1] * b[2] - a[2] * b[1];
    result[1] = a[2] * b[0] - a[0] * b[2];
    result[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double gelenk_inner(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The vector a + alpha w x a + beta w x (w x a).
static inline void gelenk_turned(const double *w, const double *a, double alpha, double beta, double *result)
{
    double once[3], twice[3];
    gelenk_cross(w, a, once);
    gelenk_cross(w, once, twice);
    for (int i = 0; i < 3; ++i) {
        result[i] = a[i] + (alpha * once[i] + beta * twice[i]);
    }
}

// Transforms the vector a from the body's frame to the parent's frame. The conjugate quaternion gives the
// inverse transformation.
static inline void gelenk_rotated(const double *q, const double *a, double *result)
{
    gelenk_turned(q, a, 2.0 * q[3], 2.0, result);
}

// The quaternion of the inverse rotation.
static inline void gelenk_conjugate(const double *q, double *result)
{
    result[0] = -q[0];
    result[1] = -q[1];
    result[2] = -q[2];
    result[3] = q[3];
}

// The product a b of quaternions x, y, z, w.
static inline void gelenk_quaternion_product(const double *a, const double *b, double *result)
{
    result[0] = a[3] * b[0] + b[3] * a[0] + (a[1] * b[2] - a[2] * b[1]);
    result[1] = a[3] * b[1] + b[3] * a[1] + (a[2] * b[0] - a[0] * b[2]);
    result[2] = a[3] * b[2] + b[3] * a[2] + (a[0] * b[1] - a[1] * b[0]);
    result[3] = a[3] * b[3] - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

// Divides the quaternion by its length.
//
// If the length is close to one, a Newton step without a square root is sufficient; its error is below 1e-16.
// The result for the quaternion 0 is NaN.
static inline void gelenk_to_unit_length(double *q)
{
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double factor = fabs(square - 1.0) < 0.00000001 ? 1.5 - 0.5 * square : 1.0 / sqrt(square);
    for (int i = 0; i < 4; ++i) {
        q[i] *= factor;
    }
}

// The attitude q exp(w) after a rotation by the vector w in the body's frame. `half` contains the Stumpff
// functions of half the angle.
static inline void gelenk_attitude_after(const double *q, const double *w, const double *half, double *result)
{
    const double s = 0.5 * half[1];
    const double turn[4] = {s * w[0], s * w[1], s * w[2], half[0]};
    gelenk_quaternion_product(q, turn, result);
    gelenk_to_unit_length(result);
}

// atan t / t for |t| <= 0.21 by its Taylor series. The remainder is below 1e-17.
static double gelenk_arctangent_over(double t)
{
    static const double coefficients[12] = {
        1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0, 1.0 / 17.0, 1.0 / 19.0,
        1.0 / 21.0, 1.0 / 23.0,
    };
    const double z = t * t;
    double sum = 0.0;
    for (int k = 11; k >= 0; --k) {
        sum = coefficients[k] - z * sum;
    }
    return sum;
}

// 2 phi / sin, where phi is the angle of the point (cos, sin) with cos, sin >= 0, and `length` is the
// distance of this point from the origin. The result is 2 / cos for sin = 0, and NaN for the origin.
//
// phi is 2 atan u with u = tan(phi/2). atan u is c + atan((u - tan c)/(1 + u tan c)) with the nearest
// multiple c of pi/8.
static double gelenk_angle_over_sine(double sine, double cosine, double length)
{
    const double u = sine / (length + cosine);
    if (u < 0.2) {
        return 4.0 * gelenk_arctangent_over(u) / (length + cosine);
    }
    // pi/8 and its tangent, or pi/4 and its tangent.
    const double center = u < 0.67 ? 0.39269908169872414 : 0.7853981633974483;
    const double tangent = u < 0.67 ? 1.4142135623730951 - 1.0 : 1.0;
    const double rest = (u - tangent) / (1.0 + u * tangent);
    return 4.0 * (center + rest * gelenk_arctangent_over(rest)) / sine;
}

// The shortest rotation vector of an attitude. Its length is at most pi. A quaternion and its negative are
// the same attitude.
static void gelenk_rotation_vector(const double *q, double *result)
{
    const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
    double factor = gelenk_angle_over_sine(sqrt(square), fabs(q[3]), sqrt(square + q[3] * q[3]));
    if (q[3] < 0.0) {
        factor = -factor;
    }
    for (int i = 0; i < 3; ++i) {
        result[i] = factor * q[i];
    }
}

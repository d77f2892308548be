// X exp(d) on SE(3): the position, then the attitude.
static void gelenk_pose_after(const double *pose, const double *d, double *result)
{
    const double *q = &pose[3], *w = &d[3];
    double half[6], c[6], turned[3], way[3];
    gelenk_stumpff(0.25 * gelenk_inner(w, w), half);
    gelenk_stumpff_doubled(half, c);
    gelenk_turned(w, d, c[2], c[3], turned);
    gelenk_rotated(q, turned, way);
    for (int i = 0; i < 3; ++i) {
        result[i] = pose[i] + way[i];
    }
    gelenk_attitude_after(q, w, half, &result[3]);
}

// (1 - (theta/2) cot(theta/2)) / theta^2 for the length theta < 2 pi of a rotation vector.
static double gelenk_half_cotangent(const double *w)
{
    double c[6];
    gelenk_stumpff(0.25 * gelenk_inner(w, w), c);
    return 0.25 * (c[2] - c[3]) / c[1];
}

// The logarithm of the pose `to` relative to the pose `from`, on SE(3).
static void gelenk_twist_between(const double *from, const double *to, double *result)
{
    double back[4], relative[4], difference[3], way[3];
    gelenk_conjugate(&from[3], back);
    gelenk_quaternion_product(back, &to[3], relative);
    double *w = &result[3];
    gelenk_rotation_vector(relative, w);
    for (int i = 0; i < 3; ++i) {
        difference[i] = to[i] - from[i];
    }
    gelenk_rotated(back, difference, way);
    gelenk_turned(w, way, -0.5, gelenk_half_cotangent(w), result);
}

// Normalizes the quaternion and returns 1. If the quaternion is zero or not finite, sets it to the identity
// and returns 0.
static bool gelenk_normalize_quaternion(double *q)
{
    double largest = 0.0;
    bool is_finite = true;
    for (int i = 0; i < 4; ++i) {
        is_finite = is_finite && fabs(q[i]) < INFINITY;
        if (fabs(q[i]) > largest) {
            largest = fabs(q[i]);
        }
    }
    if (!is_finite || largest == 0.0) {
        q[0] = q[1] = q[2] = 0.0;
        q[3] = 1.0;
        return false;
    }
    // The division avoids overflow and underflow of squares. It may be inexact for subnormal numbers, so the
    // length is corrected once more.
    for (int i = 0; i < 4; ++i) {
        q[i] /= largest;
    }
    gelenk_to_unit_length(q);
    gelenk_to_unit_length(q);
    return true;
}

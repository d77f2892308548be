// Sines and then cosines of several angles of the fast path, bit-identical to gelenk_sin_cos of each angle.
// The loop has no branch, so it becomes SIMD code. Returns 0 if an angle is too large for the fast path.
GELENK_INLINE int gelenk_sin_cos_array(int count, const double *x, double *sines_cosines)
{
    int all_direct = 1;
    for (int i = 0; i < count; ++i) {
        gelenk_sin_cos_direct(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
    for (int i = 0; i < count; ++i) {
        all_direct &= fabs(x[i]) <= GELENK_LARGEST_DIRECT_ANGLE;
    }
    return all_direct;
}

// The same results as gelenk_sin_cos. This function is outside of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_called(int count, double x, double *sines_cosines)
{
    gelenk_sin_cos(x, &sines_cosines[0], &sines_cosines[count]);
}

// Sines and cosines of several angles of the fast path, the same bits as gelenk_sin_cos of each, the cosines after the
// sines: the loop has no branch, so it becomes SIMD code. Returns 0 where an angle is too large.
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

// As gelenk_sin_cos, out of the way of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_called(int count, double x, double *sines_cosines)
{
    gelenk_sin_cos(x, &sines_cosines[0], &sines_cosines[count]);
}

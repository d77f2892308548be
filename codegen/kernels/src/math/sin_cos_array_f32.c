// Sines and cosines of several angles of the fast path, the same bits as gelenk_sin_cos_f32 of each, the cosines after the
// sines: the loop has no branch, so it becomes SIMD code. Returns 0 where an angle is too large.
GELENK_INLINE int gelenk_sin_cos_array_f32(int count, const float *x, float *sines_cosines)
{
    int all_direct = 1;
    for (int i = 0; i < count; ++i) {
        gelenk_sin_cos_direct_f32(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
    for (int i = 0; i < count; ++i) {
        all_direct &= fabsf(x[i]) <= GELENK_LARGEST_DIRECT_ANGLE;
    }
    return all_direct;
}

// As gelenk_sin_cos_f32, out of the way of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_called_f32(int count, float x, float *sines_cosines)
{
    gelenk_sin_cos_f32(x, &sines_cosines[0], &sines_cosines[count]);
}

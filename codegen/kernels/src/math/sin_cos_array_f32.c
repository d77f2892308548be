// Sines and then cosines of several angles of the fast path, bit-identical to gelenk_sin_cos_f32 of each
// angle. The loop has no branch, so it becomes SIMD code. Returns 0 if an angle is too large for the fast
// path.
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

// The same results as gelenk_sin_cos_f32. This function is outside of the usual path.
GELENK_NOINLINE static void gelenk_sin_cos_called_f32(int count, float x, float *sines_cosines)
{
    gelenk_sin_cos_f32(x, &sines_cosines[0], &sines_cosines[count]);
}

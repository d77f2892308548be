// Sines and cosines of several angles, the same bits as gelenk_sin_cos_f32 of each: the loop has no branch, so it becomes
// SIMD code. The cosines stand after the sines.
GELENK_INLINE void gelenk_sin_cos_array_f32(int count, const float *x, float *sines_cosines)
{
    int all_direct = 1;
    for (int i = 0; i < count; ++i) {
        gelenk_sin_cos_direct_f32(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
    for (int i = 0; i < count; ++i) {
        all_direct &= (x[i] >= -1.0e5f) & (x[i] <= 1.0e5f);
    }
    for (int i = 0; i < count && !all_direct; ++i) {
        gelenk_sin_cos_f32(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
}

// Sines and cosines of several angles, the same bits as gelenk_sin_cos of each: the loop has no branch, so it becomes
// SIMD code. The cosines stand after the sines.
GELENK_INLINE void gelenk_sin_cos_array(int count, const double *x, double *sines_cosines)
{
    int all_direct = 1;
    for (int i = 0; i < count; ++i) {
        gelenk_sin_cos_direct(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
    for (int i = 0; i < count; ++i) {
        all_direct &= (x[i] >= -GELENK_LARGEST_DIRECT_ANGLE) & (x[i] <= GELENK_LARGEST_DIRECT_ANGLE);
    }
    for (int i = 0; i < count && !all_direct; ++i) {
        gelenk_sin_cos(x[i], &sines_cosines[i], &sines_cosines[count + i]);
    }
}

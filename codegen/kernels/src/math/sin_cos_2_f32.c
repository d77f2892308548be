// Sines and cosines of 2 angles that are passed in registers. The function is not inlined, because the
// compiler would undo the vectorization in scalar code.
GELENK_NOINLINE static void gelenk_sin_cos_2_f32(float a, float b, float *sines_cosines)
{
    const float angles[2] = {a, b};
    if (!gelenk_sin_cos_array_f32(2, angles, sines_cosines)) {
        gelenk_sin_cos_called_f32(2, a, &sines_cosines[0]);
        gelenk_sin_cos_called_f32(2, b, &sines_cosines[1]);
    }
}

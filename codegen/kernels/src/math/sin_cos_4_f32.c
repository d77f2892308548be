// Sines and cosines of 4 angles that arrive in registers. Never inlined: among scalar code the compiler would undo the
// lanes.
GELENK_NOINLINE static void gelenk_sin_cos_4_f32(float a, float b, float c, float d, float *sines_cosines)
{
    const float angles[4] = {a, b, c, d};
    gelenk_sin_cos_array_f32(4, angles, sines_cosines);
}

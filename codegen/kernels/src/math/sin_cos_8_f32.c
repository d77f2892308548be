// Sines and cosines of 8 angles that arrive in registers. Never inlined: among scalar code the compiler would undo the
// lanes.
GELENK_NOINLINE static void gelenk_sin_cos_8_f32(float a, float b, float c, float d, float e, float f, float g, float h, float *sines_cosines)
{
    const float angles[8] = {a, b, c, d, e, f, g, h};
    gelenk_sin_cos_array_f32(8, angles, sines_cosines);
}

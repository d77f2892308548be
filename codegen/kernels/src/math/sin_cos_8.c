// Sines and cosines of 8 angles that are passed in registers. The function is not inlined, because the
// compiler would undo the vectorization in scalar code.
GELENK_NOINLINE static void gelenk_sin_cos_8(
    double a, double b, double c, double d, double e, double f, double g, double h, double *sines_cosines)
{
    const double angles[8] = {a, b, c, d, e, f, g, h};
    if (!gelenk_sin_cos_array(8, angles, sines_cosines)) {
        gelenk_sin_cos_called(8, a, &sines_cosines[0]);
        gelenk_sin_cos_called(8, b, &sines_cosines[1]);
        gelenk_sin_cos_called(8, c, &sines_cosines[2]);
        gelenk_sin_cos_called(8, d, &sines_cosines[3]);
        gelenk_sin_cos_called(8, e, &sines_cosines[4]);
        gelenk_sin_cos_called(8, f, &sines_cosines[5]);
        gelenk_sin_cos_called(8, g, &sines_cosines[6]);
        gelenk_sin_cos_called(8, h, &sines_cosines[7]);
    }
}

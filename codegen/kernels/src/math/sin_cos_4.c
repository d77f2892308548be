// Sines and cosines of 4 angles that are passed in registers. The function is not inlined, because the
// compiler would undo the vectorization in scalar code.
GELENK_NOINLINE static void gelenk_sin_cos_4(double a, double b, double c, double d, double *sines_cosines)
{
    const double angles[4] = {a, b, c, d};
    if (!gelenk_sin_cos_array(4, angles, sines_cosines)) {
        gelenk_sin_cos_called(4, a, &sines_cosines[0]);
        gelenk_sin_cos_called(4, b, &sines_cosines[1]);
        gelenk_sin_cos_called(4, c, &sines_cosines[2]);
        gelenk_sin_cos_called(4, d, &sines_cosines[3]);
    }
}

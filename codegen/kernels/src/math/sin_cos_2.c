// Sines and cosines of 2 angles that are passed in registers. The function is not inlined, because the
// compiler would undo the vectorization in scalar code.
GELENK_NOINLINE static void gelenk_sin_cos_2(double a, double b, double *sines_cosines)
{
    const double angles[2] = {a, b};
    if (!gelenk_sin_cos_array(2, angles, sines_cosines)) {
        gelenk_sin_cos_called(2, a, &sines_cosines[0]);
        gelenk_sin_cos_called(2, b, &sines_cosines[1]);
    }
}

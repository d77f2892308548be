// Sines and cosines of 2 angles that arrive in registers. Never inlined: among scalar code the compiler would undo the
// lanes.
GELENK_NOINLINE static void gelenk_sin_cos_2(double a, double b, double *sines_cosines)
{
    const double angles[2] = {a, b};
    gelenk_sin_cos_array(2, angles, sines_cosines);
}

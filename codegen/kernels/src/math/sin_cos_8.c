// Sines and cosines of 8 angles that arrive in registers. Never inlined: among scalar code the compiler would undo the
// lanes.
GELENK_NOINLINE static void gelenk_sin_cos_8(double a, double b, double c, double d, double e, double f, double g, double h, double *sines_cosines)
{
    const double angles[8] = {a, b, c, d, e, f, g, h};
    gelenk_sin_cos_array(8, angles, sines_cosines);
}


// Computes the positions y_ref (+) d, and the reference with quaternions of unit length. Returns 0 if a
// quaternion is zero or not finite.
static int gelenk_casadi_positions(const double *y_ref, const double *d, double *unit, double *y)
{
    memcpy(unit, y_ref, GELENK_NY * sizeof *unit);
    if (!gelenk_normalize(unit))
        return 0;
    gelenk_integrate(unit, d, y);
    return 1;
}

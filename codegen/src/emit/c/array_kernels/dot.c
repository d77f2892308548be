// Product a b in four partial sums. A single sum would wait for each of its terms. The remaining terms are
// added without a loop, which would keep the sums out of registers.
GELENK_INLINE double gelenk_dot(int count, const double *a, const double *b)
{
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    int k = 0;
    for (; k + 4 <= count; k += 4) {
        sums[0] = gelenk_add_product(sums[0], a[k], b[k]);
        sums[1] = gelenk_add_product(sums[1], a[k + 1], b[k + 1]);
        sums[2] = gelenk_add_product(sums[2], a[k + 2], b[k + 2]);
        sums[3] = gelenk_add_product(sums[3], a[k + 3], b[k + 3]);
    }
    if (k < count) {
        sums[0] = gelenk_add_product(sums[0], a[k], b[k]);
    }
    if (k + 1 < count) {
        sums[1] = gelenk_add_product(sums[1], a[k + 1], b[k + 1]);
    }
    if (k + 2 < count) {
        sums[2] = gelenk_add_product(sums[2], a[k + 2], b[k + 2]);
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// sum + a b, rounded once
GELENK_INLINE double gelenk_add_product(double sum, double a, double b)
{
    return fma(a, b, sum);
}

// sum + a b
GELENK_INLINE double gelenk_add_product(double sum, double a, double b)
{
    return sum + a * b;
}

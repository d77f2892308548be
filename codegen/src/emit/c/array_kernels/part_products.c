// sum + a b of each column
GELENK_INLINE gelenk_part gelenk_add_part(gelenk_part sum, gelenk_part a, gelenk_part b)
{
    return sum + a * b;
}

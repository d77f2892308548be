
#ifdef __cplusplus
extern "C" {
#endif

static void gelenk_acados_read(const void *from, int count, double *to)
{
    const struct blasfeo_dvec_args *part = (const struct blasfeo_dvec_args *)from;
    for (int i = 0; i < count; ++i)
        to[i] = BLASFEO_DVECEL(part->x, part->xi + i);
}

static void gelenk_acados_write(const double *from, int count, void *to)
{
    struct blasfeo_dvec_args *part = (struct blasfeo_dvec_args *)to;
    for (int i = 0; i < count; ++i)
        BLASFEO_DVECEL(part->x, part->xi + i) = from[i];
}

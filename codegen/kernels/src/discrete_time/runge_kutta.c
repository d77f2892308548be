// y = y + h/6 (k1 + 2 k2 + 2 k3 + k4), the end of a step of the classical Runge-Kutta method of order 4
// (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 1993, table II.1.2).
static inline void gelenk_add_rates(int count, double *y, double h, const double *k1, const double *k2,
    const double *k3, const double *k4)
{
    for (int i = 0; i < count; ++i) {
        y[i] = (((y[i] + h / 6.0 * k1[i]) + h / 3.0 * k2[i]) + h / 3.0 * k3[i]) + h / 6.0 * k4[i];
    }
}

// sum = a + factor b
static inline void gelenk_advance(int count, double *sum, const double *a, double factor, const double *b)
{
    for (int i = 0; i < count; ++i) {
        sum[i] = a[i] + factor * b[i];
    }
}

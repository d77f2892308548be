
typedef int gelenk_casadi_evaluation(const casadi_real **, casadi_real **, casadi_int *, casadi_real *, int);
typedef const casadi_int *gelenk_casadi_sparsity(casadi_int);

static casadi_int gelenk_casadi_entries_of(const casadi_int *s)
{
    return s[2] == 1 ? s[0] * s[1] : s[2 + s[1]];
}

// Writes one column of a derivative: the difference quotient of two matrices with the same sparsity, column
// by column.
static void gelenk_casadi_slope(
    const casadi_int *s, const casadi_real *above, const casadi_real *below, double step, casadi_real *column)
{
    if (s[2] == 1) {
        for (casadi_int i = 0; i < s[0] * s[1]; ++i)
            column[i] = (above[i] - below[i]) / step;
        return;
    }
    const casadi_int *row = &s[3 + s[1]];
    for (casadi_int j = 0; j < s[1]; ++j)
        for (casadi_int i = s[2 + j]; i < s[3 + j]; ++i)
            column[j * s[0] + row[i]] = (above[i] - below[i]) / step;
}

// Central differences of a function with dense inputs, with respect to the first `by` of its `inputs` inputs.
// Each result has one row per entry of an output and one column per entry of an input. The error is about
// 1e-8 of the largest entry.
static int gelenk_casadi_differences(gelenk_casadi_evaluation *function, gelenk_casadi_sparsity *sparsity_in,
    gelenk_casadi_sparsity *sparsity_out, int by, int inputs, int outputs, const casadi_real **arg, casadi_real **res,
    const casadi_real **moved, casadi_real **all, casadi_real *w, int mem)
{
    casadi_real *const above = w;
    casadi_int count = 0;
    for (int o = 0; o < outputs; ++o)
        count += gelenk_casadi_entries_of(sparsity_out(o));
    casadi_real *const below = &above[count], *const input = &below[count];
    for (int j = 0; j < by; ++j) {
        const casadi_int width = sparsity_in(j)[0];
        int is_wanted = 0;
        for (int o = 0; o < outputs; ++o)
            is_wanted |= res[o * inputs + j] != NULL;
        if (!is_wanted)
            continue;
        memcpy(moved, arg, (size_t)inputs * sizeof *moved);
        moved[j] = input;
        for (casadi_int k = 0; k < width; ++k)
            input[k] = arg[j] ? arg[j][k] : 0.0;
        for (casadi_int k = 0; k < width; ++k) {
            // This step size balances the rounding error and the error from the third derivative. It is a
            // cube root of the rounding unit.
            const double at = input[k], size = at < 0 ? -at : at, step = 6e-6 * (size > 1.0 ? size : 1.0);
            for (int side = 0; side < 2; ++side) {
                casadi_real *to = side ? below : above;
                for (int o = 0; o < outputs; to += gelenk_casadi_entries_of(sparsity_out(o)), ++o)
                    all[o] = res[o * inputs + j] ? to : NULL;
                input[k] = side ? at - step : at + step;
                if (function(moved, all, NULL, NULL, mem))
                    return 1;
            }
            input[k] = at;
            casadi_int from = 0;
            for (int o = 0; o < outputs; from += gelenk_casadi_entries_of(sparsity_out(o)), ++o) {
                const casadi_int *s = sparsity_out(o), rows = s[0] * s[1];
                casadi_real *column = res[o * inputs + j];
                if (!column || gelenk_casadi_entries_of(s) == 0)
                    continue;
                column += k * rows;
                memset(column, 0, (size_t)rows * sizeof *column);
                gelenk_casadi_slope(s, &above[from], &below[from], (at + step) - (at - step), column);
            }
        }
    }
    return 0;
}

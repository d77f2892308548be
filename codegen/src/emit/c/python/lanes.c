
// Processes eight states. Operands whose states are not adjacent, or whose single state counts for all, are
// copied through `buffer`.
static void gelenk_run_by_buffer(
    const gelenk_function *function, double **x, double *buffer, char **args, intptr_t first, const intptr_t *steps)
{
    for (int i = 0; i < function->count; ++i) {
        const int entries = function->operands[i].entries;
        const size_t size = (size_t)entries * sizeof *buffer;
        char *place = args[i] + first * steps[i];
        x[i] = i == function->parameters || steps[i] == (intptr_t)size ? (double *)(void *)place : buffer;
        for (int state = 0; i < function->inputs && x[i] == buffer && state < GELENK_LANES; ++state)
            memcpy(&buffer[state * entries], place + state * steps[i], size);
        buffer += GELENK_LANES * entries;
    }
    function->lanes(x);
    for (int i = function->inputs; i < function->count; ++i) {
        const int entries = function->operands[i].entries;
        const size_t size = (size_t)entries * sizeof *buffer;
        char *place = args[i] + first * steps[i];
        for (int state = 0; (char *)x[i] != place && state < GELENK_LANES; ++state)
            memcpy(place + state * steps[i], &x[i][state * entries], size);
    }
}

// Processes groups of eight states if the function has a version for several states and all states have the
// same free parameters. Returns the number of processed states.
static intptr_t gelenk_loop_lanes(
    const gelenk_function *function, double **x, double *buffer, char **args, intptr_t states, const intptr_t *steps)
{
    const int parameters = function->parameters;
    if (!function->lanes || (parameters >= 0 && steps[parameters] != 0))
        return 0;
    const intptr_t last = states - states % GELENK_LANES;
    int is_direct = 1;
    for (int i = 0; i < function->count; ++i) {
        is_direct &= i == parameters || steps[i] == function->operands[i].entries * (intptr_t)sizeof(double);
        x[i] = (double *)(void *)args[i];
    }
    for (intptr_t first = 0; is_direct && first < last; first += GELENK_LANES) {
        function->lanes(x);
        for (int i = 0; i < function->count; ++i)
            x[i] += i == parameters ? 0 : GELENK_LANES * function->operands[i].entries;
    }
    for (intptr_t first = 0; !is_direct && first < last; first += GELENK_LANES)
        gelenk_run_by_buffer(function, x, buffer, args, first, steps);
    return last;
}


// Processes the states one by one. All operands are read and written in place.
static void gelenk_loop_direct(
    const gelenk_function *function, double **x, char **args, intptr_t first, intptr_t states, const intptr_t *steps)
{
    for (intptr_t state = first; state < states; ++state) {
        for (int i = 0; i < function->count; ++i)
            x[i] = (double *)(void *)(args[i] + state * steps[i]);
        function->call(x);
    }
}

// Processes the states one by one. The entries of all operands are copied through `buffer`.
static void gelenk_loop_by_buffer(
    const gelenk_function *function, double **x, double *buffer, char **args, intptr_t states, const intptr_t *steps)
{
    const gelenk_operand *operands = function->operands;
    for (intptr_t state = 0; state < states; ++state) {
        double *next = buffer;
        const intptr_t *inner = steps + function->count;
        for (int i = 0; i < function->count; ++i) {
            const char *from = args[i] + state * steps[i];
            x[i] = next;
            for (int entry = 0; i < function->inputs && entry < operands[i].entries; ++entry)
                memcpy(&next[entry], from + gelenk_offset(&operands[i], inner, entry), sizeof *next);
            next += operands[i].entries;
            inner += operands[i].rank;
        }
        function->call(x);
        inner = steps + function->count;
        for (int i = 0; i < function->count; ++i) {
            char *to = args[i] + state * steps[i];
            for (int entry = 0; i >= function->inputs && entry < operands[i].entries; ++entry)
                memcpy(to + gelenk_offset(&operands[i], inner, entry), &x[i][entry], sizeof *next);
            inner += operands[i].rank;
        }
    }
}

// Calls a function for each state. Operands whose entries are not adjacent are copied through `buffer`.
static void gelenk_loop(
    const gelenk_function *function, double **x, double *buffer, char **args, intptr_t states, const intptr_t *steps)
{
    int has_gaps = 0;
    const intptr_t *inner = steps + function->count;
    for (int i = 0; i < function->count; ++i) {
        has_gaps |= !gelenk_is_dense(&function->operands[i], inner);
        inner += function->operands[i].rank;
    }
    if (has_gaps)
        gelenk_loop_by_buffer(function, x, buffer, args, states, steps);
    else
        gelenk_loop_direct(function, x, args, gelenk_loop_lanes(function, x, buffer, args, states, steps), states, steps);
    gelenk_clear_flags();
}

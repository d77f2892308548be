
#include <fenv.h>
#include <stdint.h>
#include <string.h>

// Loops over many states, which NumPy calls as generalized universal functions. `args` contains the first
// state of each operand. `dimensions` begins with the number of states. `steps` begins with the number of
// bytes from one state to the next. The number of bytes from one entry to the next follows, for each
// dimension of each operand.
#if defined(_WIN32)
#define GELENK_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define GELENK_EXPORT __attribute__((visibility("default")))
#else
#define GELENK_EXPORT
#endif

#ifdef __cplusplus
extern "C" {
#endif

// An operand: its number of dimensions, the product of their lengths, and the lengths, outermost first.
typedef struct {
    int rank;
    int entries;
    int lengths[4];
} gelenk_operand;

// A function and its operands. Operands that are read are first. `lanes` is a version for several states, or
// NULL.
typedef struct {
    void (*call)(double *const *x);
    void (*lanes)(double *const *x);
    int inputs;
    int count;
    int parameters; // index of the operand of the free parameters, -1 if there are none
    const gelenk_operand *operands;
} gelenk_function;

// Whether the entries are adjacent in memory.
static int gelenk_is_dense(const gelenk_operand *operand, const intptr_t *steps)
{
    intptr_t expected = (intptr_t)sizeof(double);
    for (int axis = operand->rank - 1; axis >= 0; --axis) {
        if (operand->lengths[axis] > 1 && steps[axis] != expected)
            return 0;
        expected *= operand->lengths[axis];
    }
    return 1;
}

static intptr_t gelenk_offset(const gelenk_operand *operand, const intptr_t *steps, int entry)
{
    intptr_t offset = 0;
    for (int axis = operand->rank - 1; axis >= 0; --axis) {
        offset += entry % operand->lengths[axis] * steps[axis];
        entry /= operand->lengths[axis];
    }
    return offset;
}

// NumPy would turn the processor's floating-point flags into warnings. The flags are cleared, because results show
// that they are not finite, and because branches whose result is not used raise flags, too.
static void gelenk_clear_flags(void)
{
    if (fetestexcept(FE_DIVBYZERO | FE_INVALID | FE_OVERFLOW | FE_UNDERFLOW))
        feclearexcept(FE_ALL_EXCEPT);
}

// Calls the online estimator of friction along a motion and prints the bits of the law that it learned; on a microcontroller it then
// prints what an update takes. The host's build (HOST) prints the same first part.

#include <stdint.h>

#include "platform.h"

enum { PERIODS = 1000, JOINTS = 2, TERMS = 5 };

// In online.rs.
void start(void);
void update(uint32_t period);
void described(uint32_t period);
uint64_t acting(uint32_t joint, uint32_t term);

#ifndef HOST

static uint32_t mean_of(void (*call)(uint32_t))
{
    const uint32_t begin = ticks();
    for (uint32_t k = 0; k < PERIODS; ++k) {
        call(k);
    }
    return ((begin - ticks()) & TICKS_MASK) * INSTRUCTIONS_PER_TICK / PERIODS;
}

static void print_number(const char *name, uint32_t value)
{
    print(name);
    print_decimal(value);
    print("\n");
}

static void update_one(const struct state *state)
{
    (void)state;
    update(PERIODS - 1);
}

#endif

int main(void)
{
    start();
#ifdef HOST
    for (uint32_t k = 0; k < PERIODS; ++k) {
        update(k);
    }
#else
    const uint32_t of_update = mean_of(update);
#endif
    for (uint32_t joint = 0; joint < JOINTS; ++joint) {
        print("result");
        for (uint32_t term = 0; term < TERMS; ++term) {
            const uint64_t bits = acting(joint, term);
            print_hexadecimal((uint32_t)(bits >> 32));
            print_hexadecimal((uint32_t)bits);
        }
        print("\n");
    }
#ifndef HOST
    print_number("instructions update", of_update);
    print_number("instructions described", mean_of(described));
    print_number("stack update", stack_of(update_one, 0));
    print_number("tick instructions", calibrated());
#endif
    return 0;
}

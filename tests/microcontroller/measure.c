// Calls the laws at seeded states and prints the bits of their results; on a microcontroller it then prints what a call
// takes. The host's build (HOST) prints the same first part.

#include <stdint.h>
#include <string.h>

#include "law.h"
#include "platform.h"

enum { STATES = 64, CALLS = 1000 };

struct state {
    struct sample desired;
    float positions[ROBOT_N];
    float velocities[ROBOT_N];
};

static struct state states[STATES];
static float results[ROBOT_N];

// A linear congruential generator (Knuth 1997, section 3.3.4); numbers between -limit and limit, exact in float.
static float number(float limit)
{
    static uint32_t seed = 16;
    seed = seed * UINT32_C(1664525) + UINT32_C(1013904223);
    return (float)(int32_t)(seed >> 8) * 1.1920929e-7f * limit - limit;
}

// Every eighth state has angles beyond the fast path of sine and cosine, which are not measured.
static void fill_states(void)
{
    for (int k = 0; k < STATES; ++k) {
        struct state *state = &states[k];
        const float turns = k % 8 == 7 ? 3.0e4f : 3.0f;
        for (int i = 0; i < ROBOT_N; ++i) {
            state->desired.positions[i] = number(turns);
            state->desired.velocities[i] = number(2.0f);
            state->desired.accelerations[i] = number(5.0f);
            state->positions[i] = state->desired.positions[i] + number(0.01f);
            state->velocities[i] = state->desired.velocities[i] + number(0.1f);
        }
    }
}

static void call_inverse_dynamics(const struct state *state)
{
    inverse_dynamics(&state->desired, results);
}

static void call_feed_forward(const struct state *state)
{
    feed_forward(&state->desired, results);
}

static void call_joint_pd(const struct state *state)
{
    joint_pd(&state->desired, state->positions, state->velocities, results);
}

typedef void law(const struct state *state);

static const struct {
    const char *name;
    law *call;
} laws[] = {
    {"inverse_dynamics", call_inverse_dynamics},
    {"feed_forward", call_feed_forward},
    {"joint_pd", call_joint_pd},
};

enum { LAWS = sizeof laws / sizeof laws[0] };

static void print_results(void)
{
    for (int which = 0; which < LAWS; ++which) {
        for (int k = 0; k < STATES; ++k) {
            laws[which].call(&states[k]);
            print("result ");
            print(laws[which].name);
            for (int i = 0; i < ROBOT_N; ++i) {
                uint32_t bits;
                memcpy(&bits, &results[i], sizeof bits);
                print_hexadecimal(bits);
            }
            print("\n");
        }
    }
}

#ifndef HOST

static void call_nothing(const struct state *state)
{
    (void)state;
}

static uint32_t ticks_of(law *call)
{
    law *volatile hidden = call; // called, not inlined
    const uint32_t start = ticks();
    for (int k = 0; k < CALLS; ++k) {
        hidden(&states[k % 4]);
    }
    return (start - ticks()) & TICKS_MASK; // the timer counts down
}

static void print_number(const char *what, const char *name, uint32_t value)
{
    print(what);
    print(name);
    print_decimal(value);
    print("\n");
}

// Instructions without those of the loop and its call, rounded; bytes of stack below that of an empty call.
static void print_measurements(void)
{
    const uint32_t none = ticks_of(call_nothing);
    const uint32_t no_stack = stack_of(call_nothing, &states[0]);
    for (int which = 0; which < LAWS; ++which) {
        const uint32_t taken = ticks_of(laws[which].call) - none;
        print_number("instructions ", laws[which].name, (taken * INSTRUCTIONS_PER_TICK + CALLS / 2) / CALLS);
        print_number("stack ", laws[which].name, stack_of(laws[which].call, &states[0]) - no_stack);
    }
    print_number("tick ", "instructions", calibrated());
}

#endif

int main(void)
{
    fill_states();
    prepare(states[0].desired.positions, 12.0f, 0.8f);
    print_results();
#ifndef HOST
    print_measurements();
#endif
    return 0;
}

// What measure.c asks of where it runs: printing, and on a microcontroller time and stack.

#ifndef PLATFORM_H
#define PLATFORM_H

#include <stdint.h>

#ifdef HOST

#include <stdio.h>

static inline void print(const char *text)
{
    fputs(text, stdout);
}

static inline void print_hexadecimal(uint32_t number)
{
    printf(" %08lx", (unsigned long)number);
}

#else

struct state;

void print(const char *text);
void print_hexadecimal(uint32_t number);
void print_decimal(uint32_t number);

// The timer of the processor: it counts down, with so many bits. QEMU's takes a tick for so many instructions with
// `-icount shift=0`: an instruction takes a nanosecond then, and the boards' clock has 25 MHz.
#define TICKS_MASK UINT32_C(0xffffff)
#define INSTRUCTIONS_PER_TICK 40u
uint32_t ticks(void);

// The measured number of instructions of a tick.
uint32_t calibrated(void);

// Bytes of stack that a call takes.
uint32_t stack_of(void (*call)(const struct state *), const struct state *state);

#endif

#endif

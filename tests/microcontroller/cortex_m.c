// Start-up, printing (Arm semihosting), time and stack of a Cortex-M4F or M7 under QEMU, whose loader fills all memory: on a
// board `.data` would have to be copied and `.bss` cleared first.

#include <stddef.h>

#include "platform.h"

int main(void);
extern uint32_t stack_top[], stack_bottom[];

enum { WRITE_TEXT = 0x04, EXIT = 0x18, EXIT_SUCCESS = 0x20026, EXIT_FAULT = 0x20024 };

// Arm, Semihosting for AArch32 and AArch64, 2.0: operation in r0, its argument in r1.
static void semihosting(uint32_t operation, uintptr_t argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void print(const char *text)
{
    semihosting(WRITE_TEXT, (uintptr_t)text);
}

void print_hexadecimal(uint32_t number)
{
    char text[10] = " ";
    for (int digit = 0; digit < 8; ++digit) {
        text[1 + digit] = "0123456789abcdef"[number >> (28 - 4 * digit) & 15];
    }
    text[9] = 0;
    print(text);
}

void print_decimal(uint32_t number)
{
    char text[12];
    size_t at = sizeof text - 1;
    text[at] = 0;
    do {
        text[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    text[--at] = ' ';
    print(&text[at]);
}

#define SYSTICK ((volatile uint32_t *)0xe000e010)

uint32_t ticks(void)
{
    return SYSTICK[2];
}

uint32_t calibrated(void)
{
    uint32_t rounds = 1000000;
    const uint32_t start = ticks();
    __asm__ volatile("1: subs %0, #1\n bne 1b" : "+l"(rounds) : : "cc");
    const uint32_t taken = (start - ticks()) & TICKS_MASK;
    return (2000000 + taken / 2) / taken;
}

uint32_t stack_of(void (*call)(const struct state *), const struct state *state)
{
    const uint32_t blank = 0xa5a5a5a5;
    volatile uint32_t *pointer;
    __asm__ volatile("mov %0, sp" : "=r"(pointer));
    for (volatile uint32_t *word = stack_bottom; word < pointer; ++word) {
        *word = blank;
    }
    call(state);
    volatile uint32_t *word = stack_bottom;
    while (word < pointer && *word == blank) {
        ++word;
    }
    return (uint32_t)((uintptr_t)pointer - (uintptr_t)word);
}

void *memcpy(void *restrict to, const void *restrict from, size_t count)
{
    uint32_t *word_to = to;
    const uint32_t *word_from = from;
    for (; count >= 4; count -= 4) {
        *word_to++ = *word_from++;
    }
    unsigned char *byte_to = (unsigned char *)word_to;
    const unsigned char *byte_from = (const unsigned char *)word_from;
    for (; count > 0; --count) {
        *byte_to++ = *byte_from++;
    }
    return to;
}

void *memset(void *to, int value, size_t count)
{
    uint32_t *word = to;
    for (; count >= 4; count -= 4) {
        *word++ = (unsigned char)value * UINT32_C(0x01010101);
    }
    unsigned char *byte = (unsigned char *)word;
    for (; count > 0; --count) {
        *byte++ = (unsigned char)value;
    }
    return to;
}

static void reset(void)
{
    // The floating-point unit: coprocessors 10 and 11 (CPACR).
    *(volatile uint32_t *)0xe000ed88 |= UINT32_C(0xf) << 20;
    __asm__ volatile("dsb\n isb");
    SYSTICK[1] = TICKS_MASK;
    SYSTICK[2] = 0;
    SYSTICK[0] = 5;
    main();
    semihosting(EXIT, EXIT_SUCCESS);
}

static void fault(void)
{
    print("fault\n");
    semihosting(EXIT, EXIT_FAULT);
}

// The stack's top, then reset, NMI and the faults.
__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
    stack_top, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault,
};

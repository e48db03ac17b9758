/// Counts instructions under QEMU with `-icount shift=10`, where an instruction takes 1024 ns and
/// the 25 MHz system timer of the MPS2 board counts 25.6 for each; and says what it counted.
#ifndef TICK_METER_H
#define TICK_METER_H

#include "cortexm/cortexm.h"
#include "link/text.h"
#include "semihost.h"

#define METER_MASK 0xFFFFFFU

static uint32_t meter_overhead;

/// 128 / 5 counts an instruction.
static inline uint32_t meter_between(uint32_t start, uint32_t end) {
    return (((start - end) & METER_MASK) * 5U + 64U) / 128U;
}

static inline uint32_t meter_now(void) {
    return CORTEXM_SYSTICK->value;
}

static inline uint32_t meter_count_loop(void) {
    uint32_t rounds = 500;
    const uint32_t start = meter_now();
    __asm volatile(".syntax unified\n1: subs %0, #1\n bne 1b" : "+l"(rounds) : : "cc", "memory");
    return meter_between(start, meter_now());
}

/// False: the emulator does not count as it should.
static inline bool meter_start(void) {
    CORTEXM_SYSTICK->reload = METER_MASK;
    CORTEXM_SYSTICK->value = 0;
    CORTEXM_SYSTICK->control = CORTEXM_SYSTICK_ENABLE | CORTEXM_SYSTICK_CORE_CLOCK;
    const uint32_t start = meter_now();
    meter_overhead = meter_between(start, meter_now());
    const uint32_t count = meter_count_loop() - meter_overhead;
    return count >= 999U && count <= 1002U;
}

static inline void meter_say(const char *what, const char *name, uint32_t number) {
    char line[96];
    struct text text;
    text_begin(&text, line, sizeof line);
    text_string(&text, what);
    text_string(&text, " ");
    text_string(&text, name);
    text_string(&text, " ");
    text_unsigned(&text, number, 0);
    text_string(&text, "\n");
    semihost_write(line, text.size_bytes);
}

#endif

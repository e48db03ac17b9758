/// Time, as the program sees it: SysTick, the cycle counter, and sleep.
#include "guest.h"

#define CYCCNT REG(0xE0001004U)

static volatile uint32_t ticks, irqs;

void sys_tick_handler(void) {
    ticks++;
}

void irq38_handler(void) {
    irqs++;
}

static void start_tick(uint32_t cycles) {
    REG(0xE000E014U) = cycles - 1U;
    REG(0xE000E018U) = 0;
    ticks = 0;
    REG(0xE000E010U) = 7;
}

/// Number of instructions of the loop: 2 a round.
__attribute__((naked, noinline)) static void spin(uint32_t rounds) {
    (void)rounds;
    __asm volatile("1: subs r0, #1\n\tbne 1b\n\tbx lr");
}

void guest_main(void) {
    REG(0xE000EDFCU) |= UINT32_C(1) << 24;
    REG(0xE0001000U) |= 1U;

    const uint32_t from = CYCCNT;
    spin(5000);
    const uint32_t spent = CYCCNT - from;
    check("an instruction is a cycle", spent >= 10000U && spent <= 10020U, 1);

    start_tick(1600);
    spin(8000); // 16,000 cycles: ten ticks, whose handlers take their time, too
    REG(0xE000E010U) = 0;
    check("a tick every 1,600 cycles", ticks == 10U || ticks == 11U, 1);

    start_tick(16000);
    const uint32_t before = CYCCNT;
    while (ticks < 10U) {
        __asm volatile("wfi");
    }
    REG(0xE000E010U) = 0;
    const uint32_t awake = CYCCNT - before;
    check("asleep the cycle counter stands", awake < 1000U, 1);

    enable(38, 0x80);
    irqs = 0;
    for (uint32_t i = 0; i < 1000U; i++) {
        pend(38);
    }
    check("every interrupt is taken", irqs, 1000);
}

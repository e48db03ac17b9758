/// What exceptions do, by the ARMv7-M Architecture Reference Manual, B1.5. Runs alike on the
/// emulated board and in QEMU (second_opinion.sh), so nothing here depends on time.
#include "guest.h"

static volatile uint32_t log_of_calls, seen_lr, seen_sp, seen_ipsr, saved_pc;
__attribute__((section(".noinit"))) static volatile uint32_t rounds;

#define ROUNDS_MAGIC 0x5EC0DE00U

/// One digit a call.
static void note(uint32_t digit) {
    log_of_calls = log_of_calls << 4 | digit;
}

static uint32_t ipsr(void) {
    uint32_t value;
    __asm volatile("mrs %0, ipsr" : "=r"(value));
    return value;
}

// ---------------------------------------------------------------- handlers

/// The handler of a fault that skips what caused it: two bytes, or four.
static void skip(uint32_t *frame) {
    saved_pc = frame[6];
    frame[6] += (*(uint16_t *)frame[6] & 0xF800U) >= 0xE800U ? 4U : 2U;
}

static volatile bool pend_more;

__attribute__((used)) static void svc_seen(uint32_t sp, uint32_t lr) {
    seen_sp = sp;
    seen_lr = lr;
    seen_ipsr = ipsr();
    note(1);
    if (pend_more) {
        SCB_ICSR = UINT32_C(1) << 28; // PendSV
        __asm volatile("dsb\n\tisb");
        note(2);
    }
}

/// Spoils what a function may spoil, so that only the frame can bring it back.
__attribute__((naked)) void svc_handler(void) {
    __asm volatile("mov r0, sp\n\tmov r1, lr\n\tpush {r4, lr}\n\tbl svc_seen\n\t"
                   "mov r0, #1\n\tmov r1, #2\n\tmov r2, #3\n\tmov r3, #4\n\tmov r12, #5\n\t"
                   "cmp r0, #1\n\tpop {r4, pc}");
}

void pend_sv_handler(void) {
    note(3);
}

void nmi_handler(void) {
    note(9);
}

void irq37_handler(void) {
    note(7);
}

void irq38_handler(void) {
    note(8);
    pend(39); // higher: now
    pend(37); // lower: later
    note(8);
}

void irq39_handler(void) {
    note(0xA);
}

static volatile uint32_t fault_cfsr, fault_hfsr, fault_address, fault_number, fault_count;

__attribute__((used)) static void fault_seen(uint32_t *frame) {
    fault_cfsr = SCB_CFSR;
    fault_hfsr = SCB_HFSR;
    fault_address = SCB_BFAR;
    fault_number = ipsr();
    fault_count++;
    SCB_CFSR = 0xFFFFFFFFU;
    SCB_HFSR = 0xFFFFFFFFU;
    if ((frame[7] >> 24 & 1U) == 0U) {
        frame[7] |= 1U << 24; // the processor was not in Thumb state: go back to the caller
        frame[6] = frame[5] & ~1U;
        return;
    }
    skip(frame);
}

#define FAULT_HANDLER(name)                                                                        \
    __attribute__((naked)) void name(void) {                                                       \
        __asm volatile("mov r0, sp\n\tb fault_seen");                                              \
    }
FAULT_HANDLER(hard_fault_handler)
FAULT_HANDLER(bus_fault_handler)
FAULT_HANDLER(usage_fault_handler)

static volatile uint32_t ticks;
void sys_tick_handler(void) {
    ticks++;
}

// ---------------------------------------------------------------- calls and returns

static void test_svc(void) {
    register uint32_t r0 __asm("r0") = 0x100, r1 __asm("r1") = 0x101, r2 __asm("r2") = 0x102,
                         r3 __asm("r3") = 0x103, r12 __asm("r12") = 0x112;
    uint32_t flags;
    log_of_calls = 0;
    __asm volatile("mov %5, #0xA0000000\n\tmsr apsr_nzcvq, %5\n\tsvc 0\n\tmrs %5, apsr"
                   : "+r"(r0), "+r"(r1), "+r"(r2), "+r"(r3), "+r"(r12), "=&r"(flags)::"cc",
                     "memory");
    const uint32_t sum = r0 + r1 + r2 + r3 + r12;
    check("svc runs its handler", log_of_calls, 1);
    check("svc keeps the registers", sum, 0x100 + 0x101 + 0x102 + 0x103 + 0x112);
    check("svc keeps the flags", flags & 0xF0000000U, 0xA0000000U);
    check("svc has number 11", seen_ipsr, 11);
    check("svc returns to the main stack", seen_lr, 0xFFFFFFF9U);
}

static void test_alignment(void) {
    uint32_t before, after;
    __asm volatile("sub sp, #4\n\tmov %0, sp\n\tsvc 0\n\tmov %1, sp\n\tadd sp, #4"
                   : "=&r"(before), "=&r"(after)::"r0", "r1", "r2", "r3", "r12", "lr", "memory");
    uint32_t odd = before & 7U;
    check("a frame is aligned", seen_sp & 7U, 0);
    __asm volatile("sub sp, #8\n\tmov %0, sp\n\tsvc 0\n\tmov %1, sp\n\tadd sp, #8"
                   : "=&r"(before), "=&r"(after)::"r0", "r1", "r2", "r3", "r12", "lr", "memory");
    check("and so is the other one", seen_sp & 7U, 0);
    check("the stack comes back", after, before);
    check("one of both was odd", odd ^ (before & 7U), 4);
}

static uint32_t process_stack[64];

static void test_process_stack(void) {
    uint32_t psp;
    __asm volatile("msr psp, %1\n\tmrs r4, control\n\torr r5, r4, #2\n\tmsr control, r5\n\tisb\n\t"
                   "svc 0\n\tmov %0, sp\n\tmsr control, r4\n\tisb"
                   : "=&r"(psp)
                   : "r"(&process_stack[64])
                   : "r0", "r1", "r2", "r3", "r4", "r5", "r12", "lr", "memory");
    check("from the process stack", seen_lr, 0xFFFFFFFDU);
    check("which comes back", psp, (uint32_t)(uintptr_t)&process_stack[64]);
    check("handlers have the main stack", (seen_sp - 0x20000000U) > 0x4000U, 1);
}

static void test_it_block(void) {
    uint32_t sum;
    __asm volatile("mov %0, #0\n\tcmp %0, #0\n\titete eq\n\tsvceq 0\n\taddne %0, #1\n\t"
                   "addeq %0, #2\n\taddne %0, #4"
                   : "=&r"(sum)::"r0", "r1", "r2", "r3", "r12", "cc", "memory");
    check("inside of an IT block", sum, 2);
}

// ---------------------------------------------------------------- who goes first

static void test_order(void) {
    log_of_calls = 0;
    pend_more = true;
    __asm volatile("svc 0" ::: "memory");
    pend_more = false;
    check("PendSV waits for the end of SVC", log_of_calls, 0x123);

    enable(37, 0xC0);
    enable(38, 0x80);
    enable(39, 0x40);
    log_of_calls = 0;
    pend(38);
    check("nested by priority", log_of_calls, 0x8A87);

    SCB_AIRCR = 0x05FA0000U | 7U << 8; // no bit decides who preempts
    log_of_calls = 0;
    pend(38);
    check("subpriorities only order", log_of_calls, 0x88A7);
    SCB_AIRCR = 0x05FA0000U;
}

static void test_masks(void) {
    log_of_calls = 0;
    __asm volatile("cpsid i" ::: "memory");
    pend(39);
    note(1);
    SCB_ICSR = UINT32_C(1) << 31; // NMI
    __asm volatile("dsb\n\tisb\n\tnop\n\tnop");
    note(2);
    __asm volatile("cpsie i\n\tisb" ::: "memory");
    note(3);
    check("PRIMASK holds interrupts back, NMI not", log_of_calls, 0x192A3);

    log_of_calls = 0;
    __asm volatile("msr basepri, %0\n\tisb" ::"r"(0x80) : "memory");
    pend(37);
    note(1);
    pend(39);
    note(2);
    __asm volatile("msr basepri, %0\n\tisb" ::"r"(0) : "memory");
    note(3);
    check("BASEPRI by number", log_of_calls, 0x1A273);

    log_of_calls = 0;
    __asm volatile("cpsid f" ::: "memory");
    pend(39);
    note(1);
    __asm volatile("cpsie f\n\tisb" ::: "memory");
    note(2);
    check("FAULTMASK", log_of_calls, 0x1A2);
}

static void test_sleep(void) {
    log_of_calls = 0;
    __asm volatile("cpsid i" ::: "memory");
    pend(39);
    note(1);
    __asm volatile("wfi" ::: "memory"); // wakes though PRIMASK is set
    note(2);
    __asm volatile("cpsie i\n\tisb" ::: "memory");
    note(3);
    check("WFI wakes with PRIMASK", log_of_calls, 0x12A3);

    REG(0xE000E014U) = 15999;
    REG(0xE000E018U) = 0;
    REG(0xE000E010U) = 7;
    while (ticks < 3U) {
        __asm volatile("wfi");
    }
    REG(0xE000E010U) = 0;
    check("SysTick wakes", ticks >= 3U, 1);
}

// ---------------------------------------------------------------- faults

__attribute__((naked, noinline)) static void undefined(void) {
    __asm volatile("udf #1\n\tbx lr");
}

__attribute__((naked, noinline)) static uint32_t read_nothing(uint32_t address) {
    (void)address;
    __asm volatile("ldr r0, [r0]\n\tbx lr");
}

static void test_faults(void) {
    SCB_SHCSR = 7U << 16;
    undefined();
    check("an undefined instruction is a usage fault", fault_number, 6);
    check("UNDEFINSTR", fault_cfsr, UINT32_C(1) << 16);
    check("its address is in the frame", saved_pc, (uint32_t)(uintptr_t)undefined & ~1U);

    (void)read_nothing(0x60000000U);
    check("a read of nothing is a bus fault", fault_number, 5);
    check("PRECISERR, BFARVALID", fault_cfsr, 0x8200);
    check("BFAR", fault_address, 0x60000000U);

    ((void (*)(void))((uintptr_t)undefined & ~(uintptr_t)1))();
    check("a call without the Thumb bit is a usage fault", fault_number, 6);
    check("INVSTATE", fault_cfsr, UINT32_C(1) << 17);

    SCB_SHCSR = 0;
    undefined();
    check("without its handler it is a hard fault", fault_number, 3);
    check("FORCED", fault_hfsr, UINT32_C(1) << 30);
    check("and the cause is told", fault_cfsr, UINT32_C(1) << 16);

    SCB_SHCSR = 7U << 16;
    __asm volatile("cpsid i" ::: "memory");
    undefined();
    __asm volatile("cpsie i" ::: "memory");
    check("PRIMASK makes it a hard fault", fault_number, 3);
    check("no fault was missed", fault_count, 5);
}

void guest_main(void) {
    if ((rounds & 0xFFFFFF00U) == ROUNDS_MAGIC) {
        rounds = 0;
        check("a reset by software starts anew", log_of_calls, 0);
        return;
    }
    test_svc();
    test_alignment();
    test_process_stack();
    test_it_block();
    test_order();
    test_masks();
    test_sleep();
    test_faults();
    log_of_calls = 5;
    rounds = ROUNDS_MAGIC;
    while ((REG(0x40011000U) & 0x40U) == 0U) { // TC: what is on its way would be cut off
    }
    SCB_AIRCR = 0x05FA0004U;
    for (;;) {
    }
}

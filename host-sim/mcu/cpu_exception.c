/// Entry to and return from exceptions: ARMv7-M Architecture Reference Manual, B1.5.6 to B1.5.8.
#include "mcu/cpu.h"

#include <stdio.h>
#include <unicorn/unicorn.h>

#define ENTRY_CYCLES  12U
#define RETURN_CYCLES 10U
#define CHAIN_CYCLES  6U
#define FRAME_BYTES   32U

#define XPSR_FLAGS     0xF80F0000U // NZCVQ and GE
#define XPSR_THUMB     (UINT32_C(1) << 24)
#define XPSR_ALIGNED   (UINT32_C(1) << 9)
#define XPSR_EXCEPTION 0x1FFU
#define CONTROL_SPSEL  2U
#define CCR_STKALIGN   0x200U

#define RETURN_HANDLER     0xFFFFFFF1U
#define RETURN_THREAD_MAIN 0xFFFFFFF9U
#define RETURN_THREAD_PSP  0xFFFFFFFDU

static uint32_t get(const struct cpu *cpu, int id) {
    uint32_t value = 0;
    (void)uc_reg_read(cpu->engine, id, &value);
    return value;
}

static void set(struct cpu *cpu, int id, uint32_t value) {
    (void)uc_reg_write(cpu->engine, id, &value);
}

static void go_to(struct cpu *cpu, uint32_t pc) {
    cpu->pc = pc & ~1U;
    set(cpu, UC_ARM_REG_PC, pc);
}

void cpu_lock_up(struct cpu *cpu, const char *why, uint32_t value) {
    cpu->state = CPU_LOCKED_UP;
    snprintf(cpu->why_locked_up, sizeof cpu->why_locked_up, "%s (0x%08X)", why, value);
    soc_complain(cpu->soc, "the processor locks up: %s (0x%08X)", why, value);
    cpu->stopping = true;
    (void)uc_emu_stop(cpu->engine);
}

// ---------------------------------------------------------------- entry

/// Address of a handler. After reset the vectors are where the flash shows up at address 0.
static bool read_vector(const struct cpu *cpu, unsigned exception, uint32_t *vector) {
    const uint32_t vtor = cpu->soc->scb.vtor;
    const uint32_t base = vtor < CPU_FLASH_BYTES ? vtor + CPU_FLASH_BASE : vtor;
    return cpu_load(cpu, base + 4U * exception, vector, sizeof *vector);
}

static void start_handler(struct cpu *cpu, unsigned exception, uint32_t exc_return) {
    uint32_t vector;
    if (!read_vector(cpu, exception, &vector)) {
        cpu->soc->scb.hfsr |= SCB_HFSR_VECTTBL;
        cpu_lock_up(cpu, "the vector table is not in memory", cpu->soc->scb.vtor);
        return;
    }
    if (cpu->soc->nvic.active_group == NVIC_PRIORITY_THREAD) {
        cpu->handler_from = cpu_instructions(cpu);
    }
    nvic_activate(&cpu->soc->nvic, exception);
    cpu->soc->nvic.event = true; // entry and return are events, to WFE
    cpu->soc->scb.exception = exception;
    cpu->exceptions++;
    set(cpu, UC_ARM_REG_XPSR, (get(cpu, UC_ARM_REG_XPSR) & XPSR_FLAGS) | XPSR_THUMB | exception);
    set(cpu, UC_ARM_REG_LR, exc_return);
    go_to(cpu, vector);
}

static void enter(struct cpu *cpu, unsigned exception, uint32_t pc) {
    const uint32_t xpsr = get(cpu, UC_ARM_REG_XPSR), sp = get(cpu, UC_ARM_REG_SP);
    const uint32_t control = get(cpu, UC_ARM_REG_CONTROL);
    const bool in_handler = (xpsr & XPSR_EXCEPTION) != 0U;
    const bool on_psp = !in_handler && (control & CONTROL_SPSEL) != 0U;
    const bool align = (cpu->soc->scb.ccr & CCR_STKALIGN) != 0U && (sp & 4U) != 0U;
    const uint32_t frame_at = sp - FRAME_BYTES - (align ? 4U : 0U);
    const uint32_t frame[8] = {get(cpu, UC_ARM_REG_R0),
                               get(cpu, UC_ARM_REG_R1),
                               get(cpu, UC_ARM_REG_R2),
                               get(cpu, UC_ARM_REG_R3),
                               get(cpu, UC_ARM_REG_R12),
                               get(cpu, UC_ARM_REG_LR),
                               pc,
                               (xpsr & ~XPSR_ALIGNED) | (align ? XPSR_ALIGNED : 0U)};
    if (!cpu_store(cpu, frame_at, frame, sizeof frame)) {
        cpu_lock_up(cpu, "no memory for an exception's frame: has the stack overflowed?", frame_at);
        return;
    }
    set(cpu, UC_ARM_REG_SP, frame_at);
    if (on_psp) { // handlers run on the main stack
        set(cpu, UC_ARM_REG_CONTROL, control & ~CONTROL_SPSEL);
    }
    cpu_spend(cpu, ENTRY_CYCLES);
    start_handler(cpu, exception,
                  in_handler ? RETURN_HANDLER
                  : on_psp   ? RETURN_THREAD_PSP
                             : RETURN_THREAD_MAIN);
}

bool cpu_take_pending(struct cpu *cpu, uint32_t pc) {
    if (!cpu->soc->nvic.attention) {
        return false;
    }
    const struct nvic_masks masks = cpu_masks(cpu);
    const unsigned exception = nvic_preempts(&cpu->soc->nvic, &masks);
    if (exception == 0U) {
        return false;
    }
    enter(cpu, exception, pc);
    return true;
}

void cpu_raise(struct cpu *cpu, unsigned exception, uint32_t pc) {
    const struct nvic *nvic = &cpu->soc->nvic;
    const struct nvic_masks masks = cpu_masks(cpu);
    if (!nvic_can_take(nvic, exception, &masks)) {
        if (!nvic_can_take(nvic, NVIC_HARD_FAULT, &masks)) {
            cpu_lock_up(cpu, "a fault inside the handler of a hard fault or NMI", pc);
            return;
        }
        if (exception != NVIC_HARD_FAULT) {
            cpu->soc->scb.hfsr |= SCB_HFSR_FORCED;
        }
        exception = NVIC_HARD_FAULT;
    }
    enter(cpu, exception, pc);
}

// ---------------------------------------------------------------- return

/// A return that can't be right is a usage fault of the code that returned.
static void refuse_return(struct cpu *cpu, uint32_t exc_return) {
    cpu->soc->scb.cfsr |= SCB_CFSR_INVPC;
    cpu_raise(cpu, NVIC_USAGE_FAULT, exc_return);
}

/// Takes the frame off its stack and goes on where it says.
static void restore(struct cpu *cpu, uint32_t exc_return) {
    static const int ids[] = {UC_ARM_REG_R0, UC_ARM_REG_R1,  UC_ARM_REG_R2,
                              UC_ARM_REG_R3, UC_ARM_REG_R12, UC_ARM_REG_LR};
    const bool on_psp = exc_return == RETURN_THREAD_PSP;
    const uint32_t sp = get(cpu, on_psp ? UC_ARM_REG_PSP : UC_ARM_REG_MSP);
    uint32_t frame[8];
    if (!cpu_load(cpu, sp, frame, sizeof frame)) {
        cpu_lock_up(cpu, "an exception's frame is not in memory", sp);
        return;
    }
    const uint32_t xpsr = frame[7];
    if (((xpsr & XPSR_EXCEPTION) != 0U) != (exc_return == RETURN_HANDLER)) {
        refuse_return(cpu, exc_return);
        return;
    }
    const bool aligned = (xpsr & XPSR_ALIGNED) != 0U && (cpu->soc->scb.ccr & CCR_STKALIGN) != 0U;
    for (unsigned i = 0; i < sizeof ids / sizeof *ids; i++) {
        set(cpu, ids[i], frame[i]);
    }
    set(cpu, UC_ARM_REG_XPSR, xpsr & ~XPSR_ALIGNED);
    if (exc_return != RETURN_HANDLER) {
        const uint32_t control = get(cpu, UC_ARM_REG_CONTROL) & ~CONTROL_SPSEL;
        set(cpu, UC_ARM_REG_CONTROL, control | (on_psp ? CONTROL_SPSEL : 0U));
    }
    set(cpu, UC_ARM_REG_SP, sp + FRAME_BYTES + (aligned ? 4U : 0U));
    cpu->soc->scb.exception = xpsr & XPSR_EXCEPTION;
    cpu->soc->nvic.event = true;
    cpu_spend(cpu, RETURN_CYCLES);
    go_to(cpu, frame[6] | ((xpsr & XPSR_THUMB) != 0U ? 1U : 0U));
}

void cpu_return(struct cpu *cpu, uint32_t exc_return) {
    struct nvic *nvic = &cpu->soc->nvic;
    const unsigned exception = get(cpu, UC_ARM_REG_XPSR) & XPSR_EXCEPTION;
    const bool to_handler = exc_return == RETURN_HANDLER;
    const bool known =
        to_handler || exc_return == RETURN_THREAD_MAIN || exc_return == RETURN_THREAD_PSP;
    const unsigned active = nvic_active_count(nvic);
    if (!known || exception == 0U || !nvic_test(nvic->active, exception) ||
        to_handler != (active > 1U)) {
        refuse_return(cpu, exc_return);
        return;
    }
    nvic_deactivate(nvic, exception);
    soc_alert(cpu->soc); // what runs next may have to wait, or to hang
    if (exception != NVIC_NMI) {
        set(cpu, UC_ARM_REG_FAULTMASK, 0);
    }
    const struct nvic_masks masks = cpu_masks(cpu);
    const unsigned next = nvic_preempts(nvic, &masks);
    if (!to_handler) {
        cpu->handler_instructions += cpu_instructions(cpu) - cpu->handler_from;
        cpu->handler_from = cpu_instructions(cpu);
    }
    if (next != 0U) { // tail-chaining: the frame stays where it is
        cpu_spend(cpu, CHAIN_CYCLES);
        start_handler(cpu, next, exc_return);
        return;
    }
    restore(cpu, exc_return);
    if (!to_handler && cpu->state == CPU_RUNS && scb_sleeps_on_exit(&cpu->soc->scb)) {
        cpu->state = CPU_SLEEPS;
        cpu->stopping = true;
        (void)uc_emu_stop(cpu->engine);
    }
}

#include "mcu/cpu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unicorn/unicorn.h>

#define SYSTEM_BASE   0x1FFF7000U
#define SYSTEM_BYTES  0x1000U
#define NEVER_REACHED 0xFFFF0000U

/// What libunicorn calls the reasons for its interrupt hook.
enum { INTERRUPT_SVC = 2, INTERRUPT_BKPT = 7, INTERRUPT_RETURN = 8 };

#define WFI   0xBF30U
#define WFE   0xBF20U
#define YIELD 0xBF10U

// ---------------------------------------------------------------- memory

/// Where an address is on the host; NULL: not all of it is in one memory.
static uint8_t *memory_at(const struct cpu *cpu, uint32_t address, uint32_t size_bytes) {
    const struct {
        uint32_t base, size;
        uint8_t *bytes;
    } memories[] = {{CPU_FLASH_BASE, CPU_FLASH_BYTES, cpu->flash},
                    {CPU_RAM_BASE, CPU_RAM_BYTES, cpu->ram},
                    {CPU_CCM_BASE, CPU_CCM_BYTES, cpu->ccm},
                    {SYSTEM_BASE, SYSTEM_BYTES, cpu->system}};
    for (unsigned i = 0; i < sizeof memories / sizeof *memories; i++) {
        const uint32_t at = address - memories[i].base;
        if (at <= memories[i].size && memories[i].size - at >= size_bytes) {
            return memories[i].bytes + at;
        }
    }
    return NULL;
}

bool cpu_load(const struct cpu *cpu, uint32_t address, void *to, uint32_t size_bytes) {
    const uint8_t *from = memory_at(cpu, address, size_bytes);
    if (from == NULL) {
        return false;
    }
    memcpy(to, from, size_bytes);
    return true;
}

bool cpu_store(struct cpu *cpu, uint32_t address, const void *from, uint32_t size_bytes) {
    uint8_t *to = memory_at(cpu, address, size_bytes);
    if (to == NULL || (address >= CPU_FLASH_BASE && address < CPU_RAM_BASE)) {
        return false;
    }
    memcpy(to, from, size_bytes);
    return true;
}

static uint16_t half_at(const struct cpu *cpu, uint32_t address) {
    uint16_t half = 0;
    (void)cpu_load(cpu, address, &half, sizeof half);
    return half;
}

// ---------------------------------------------------------------- registers

uint32_t cpu_register(struct cpu *cpu, unsigned number) {
    static const int ids[] = {UC_ARM_REG_R0,  UC_ARM_REG_R1, UC_ARM_REG_R2,  UC_ARM_REG_R3,
                              UC_ARM_REG_R4,  UC_ARM_REG_R5, UC_ARM_REG_R6,  UC_ARM_REG_R7,
                              UC_ARM_REG_R8,  UC_ARM_REG_R9, UC_ARM_REG_R10, UC_ARM_REG_R11,
                              UC_ARM_REG_R12, UC_ARM_REG_SP, UC_ARM_REG_LR,  UC_ARM_REG_PC};
    uint32_t value = 0;
    (void)uc_reg_read(cpu->engine, ids[number & 15U], &value);
    return value;
}

struct nvic_masks cpu_masks(const struct cpu *cpu) {
    uint32_t primask = 0, faultmask = 0, basepri = 0;
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_PRIMASK, &primask);
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_FAULTMASK, &faultmask);
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_BASEPRI, &basepri);
    return (struct nvic_masks){(primask & 1U) != 0U, (faultmask & 1U) != 0U,
                               (uint8_t)(basepri & 0xF0U)};
}

void cpu_spend(struct cpu *cpu, uint64_t cycles) {
    cpu->soc->cycle += cycles;
    cpu->other_cycles += cycles;
}

// ---------------------------------------------------------------- between blocks

static void stop(struct cpu *cpu, uint32_t pc) {
    cpu->pc = pc;
    cpu->stopping = true;
    (void)uc_emu_stop(cpu->engine);
}

static bool can_hang(const struct cpu *cpu) {
    return cpu->hangs_from <= NVIC_PRIORITY_THREAD;
}

static bool is_hanging(const struct cpu *cpu) {
    return cpu->soc->nvic.active_group >= cpu->hangs_from;
}

/// Something other than the program wants to happen. Returns: whether the block at pc still runs.
static bool attend(struct cpu *cpu, uint32_t pc) {
    struct soc *soc = cpu->soc;
    for (;;) {
        soc_run_due(soc);
        if (soc->reset_wanted != SOC_RESET_NONE || soc->ended) {
            stop(cpu, pc);
            return false;
        }
        if (soc->nvic.attention && cpu_take_pending(cpu, pc)) {
            return false;
        }
        if (!is_hanging(cpu)) {
            return true;
        }
        cpu_spend(cpu, soc->next_cycle > soc->cycle ? soc->next_cycle - soc->cycle : 0U);
    }
}

static uint16_t count_instructions(const struct cpu *cpu, uint32_t address, uint32_t size_bytes) {
    uint16_t count = 0;
    for (uint32_t at = 0; at < size_bytes; count++) {
        at += half_at(cpu, address + at) >= 0xE800U ? 4U : 2U; // 32-bit Thumb begins so
    }
    return count;
}

static bool is_watched(const struct cpu *cpu, uint32_t place) {
    return (cpu->watched[place / 64U] >> (place / 2U % 32U) & 1U) != 0U;
}

/// A block that is met for the first time, is watched, or lies outside of the flash.
/// Returns: its instructions; 0: it does not run now.
static uint32_t meet_block(struct cpu *cpu, uint32_t address, uint32_t size_bytes) {
    const uint32_t place = address - CPU_FLASH_BASE;
    const uint16_t instructions = count_instructions(cpu, address, size_bytes);
    if (place >= CPU_FLASH_BYTES) {
        return instructions;
    }
    if (is_watched(cpu, place)) {
        cpu->watcher(cpu->watcher_context, cpu, address);
        return is_hanging(cpu) && !attend(cpu, address) ? 0U : instructions;
    }
    cpu->blocks[place / 2U] = (struct cpu_block){(uint16_t)size_bytes, instructions};
    return instructions;
}

/// Called before each basic block, some hundred million times a second: short.
static void on_block(uc_engine *engine, uint64_t address64, uint32_t size_bytes, void *user) {
    struct cpu *cpu = user;
    struct soc *soc = cpu->soc;
    const uint32_t address = (uint32_t)address64, place = address - CPU_FLASH_BASE;
    (void)engine;
    if (soc->cycle >= soc->attend_cycle && !attend(cpu, address)) {
        return;
    }
    cpu->block_address = address;
    cpu->block_bytes = size_bytes;
    if (place < CPU_FLASH_BYTES && cpu->blocks[place / 2U].size_bytes == size_bytes) {
        soc->cycle += cpu->blocks[place / 2U].instructions;
    } else {
        soc->cycle += meet_block(cpu, address, size_bytes);
    }
}

static void on_instruction(uc_engine *engine, uint64_t address, uint32_t size_bytes, void *user) {
    struct cpu *cpu = user;
    (void)engine;
    (void)size_bytes;
    cpu->exact_pc = (uint32_t)address;
    cpu->stepped++;
}

static void on_interrupt(uc_engine *engine, uint32_t number, void *user) {
    struct cpu *cpu = user;
    uint32_t pc;
    (void)uc_reg_read(engine, UC_ARM_REG_PC, &pc);
    switch (number) {
    case INTERRUPT_RETURN:
        cpu_return(cpu, pc | 1U);
        return;
    case INTERRUPT_SVC:
        cpu_raise(cpu, NVIC_SVCALL, pc);
        return;
    case INTERRUPT_BKPT: // without a debugger
        cpu->soc->scb.hfsr |= SCB_HFSR_DEBUGEVT;
        cpu_raise(cpu, NVIC_HARD_FAULT, pc);
        return;
    default:
        cpu->soc->scb.cfsr |= SCB_CFSR_UNDEFINSTR;
        cpu_raise(cpu, NVIC_USAGE_FAULT, pc);
        return;
    }
}

static uint64_t on_read(uc_engine *engine, uint64_t offset, unsigned size_bytes, void *user) {
    struct cpu *cpu = ((void **)user)[0];
    (void)engine;
    return soc_read(cpu->soc, (uint32_t)((uintptr_t)((void **)user)[1] + offset), size_bytes);
}

static void on_write(uc_engine *engine, uint64_t offset, unsigned size_bytes, uint64_t value,
                     void *user) {
    struct cpu *cpu = ((void **)user)[0];
    (void)engine;
    soc_write(cpu->soc, (uint32_t)((uintptr_t)((void **)user)[1] + offset), size_bytes,
              (uint32_t)value);
}

static bool on_bad_access(uc_engine *engine, uc_mem_type type, uint64_t address, int size_bytes,
                          int64_t value, void *user) {
    struct cpu *cpu = user;
    (void)engine;
    (void)type;
    (void)size_bytes;
    (void)value;
    cpu->fault_address = (uint32_t)address;
    return false; // the run ends with an error, and the fault is taken there
}

// ---------------------------------------------------------------- faults

/// What the error that ended a run means to the program.
static void take_fault(struct cpu *cpu, int error) {
    struct scb *scb = &cpu->soc->scb;
    uint32_t pc, xpsr;
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_PC, &pc);
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_XPSR, &xpsr);
    unsigned exception = NVIC_BUS_FAULT;
    uint32_t at = cpu->exact ? cpu->exact_pc : cpu->block_address;
    switch (error) {
    case UC_ERR_READ_UNMAPPED:
    case UC_ERR_READ_PROT:
    case UC_ERR_READ_UNALIGNED:
        scb->cfsr |= SCB_CFSR_PRECISERR | SCB_CFSR_BFARVALID;
        scb->bfar = cpu->fault_address;
        break;
    case UC_ERR_WRITE_UNMAPPED:
    case UC_ERR_WRITE_PROT:
    case UC_ERR_WRITE_UNALIGNED:
        scb->cfsr |= SCB_CFSR_IMPRECISERR; // writes are buffered: the address is lost
        break;
    case UC_ERR_FETCH_UNMAPPED:
    case UC_ERR_FETCH_PROT:
    case UC_ERR_FETCH_UNALIGNED:
        at = pc;
        // Above 0x40000000 lies nothing that may be executed.
        if (pc >= 0x40000000U) {
            exception = NVIC_MEM_MANAGE;
            scb->cfsr |= SCB_CFSR_IACCVIOL;
        } else {
            scb->cfsr |= SCB_CFSR_IBUSERR;
        }
        break;
    default: // an instruction that does not exist
        at = pc;
        exception = NVIC_USAGE_FAULT;
        scb->cfsr |= (xpsr >> 24 & 1U) != 0U ? SCB_CFSR_UNDEFINSTR : SCB_CFSR_INVSTATE;
        break;
    }
    cpu_raise(cpu, exception, at);
}

/// libunicorn ends a run behind WFE and YIELD as if they were undefined.
static bool was_hint(const struct cpu *cpu, uint32_t pc, uint16_t hint) {
    return cpu->block_address + cpu->block_bytes == pc && half_at(cpu, pc - 2U) == hint;
}

static void fall_asleep(struct cpu *cpu, bool for_event) {
    struct nvic *nvic = &cpu->soc->nvic;
    const struct nvic_masks masks = cpu_masks(cpu);
    cpu->waits_for_event = for_event;
    if (for_event && nvic->event) {
        nvic->event = false;
    } else if (!nvic_wakes(nvic, &masks)) {
        cpu->state = CPU_SLEEPS;
    }
}

/// Lets the program run until something stops it.
static void execute(struct cpu *cpu) {
    cpu->stopping = false;
    const uc_err error = uc_emu_start(cpu->engine, cpu->pc | 1U, NEVER_REACHED, 0, 0);
    if (cpu->stopping) {
        return;
    }
    uint32_t pc;
    (void)uc_reg_read(cpu->engine, UC_ARM_REG_PC, &pc);
    cpu->pc = pc;
    if (error == UC_ERR_OK && half_at(cpu, pc - 2U) == WFI) {
        fall_asleep(cpu, false);
    } else if (error == UC_ERR_INSN_INVALID && was_hint(cpu, pc, WFE)) {
        fall_asleep(cpu, true);
    } else if (error == UC_ERR_INSN_INVALID && was_hint(cpu, pc, YIELD)) {
        return;
    } else if (error == UC_ERR_OK) {
        cpu_lock_up(cpu, "the emulator stopped without a reason", pc);
    } else {
        take_fault(cpu, (int)error);
    }
}

// ---------------------------------------------------------------- running

/// Sleeping or locked up: time passes until something happens.
static void pass_time(struct cpu *cpu) {
    struct soc *soc = cpu->soc;
    const struct nvic_masks masks = cpu_masks(cpu);
    const bool event = cpu->waits_for_event && soc->nvic.event;
    if (cpu->state == CPU_SLEEPS && (event || nvic_wakes(&soc->nvic, &masks))) {
        soc->nvic.event = soc->nvic.event && !event;
        cpu->state = CPU_RUNS;
        return;
    }
    if (soc->next_cycle > soc->cycle) {
        soc->slept_cycles += soc->next_cycle - soc->cycle;
        soc->cycle = soc->next_cycle;
    }
}

void cpu_run(struct cpu *cpu, uint64_t until_ns) {
    struct soc *soc = cpu->soc;
    soc_set_end(soc, until_ns);
    for (;;) {
        soc_run_due(soc);
        if (soc->ended) {
            return;
        }
        if (soc->reset_wanted != SOC_RESET_NONE) {
            soc_reset(soc, soc->reset_wanted);
            cpu_reset(cpu);
            cpu->resets++;
        } else if (cpu->state != CPU_RUNS) {
            pass_time(cpu);
        } else if (!cpu_take_pending(cpu, cpu->pc)) {
            if (can_hang(cpu)) {
                soc_alert(soc);
            }
            execute(cpu);
        }
    }
}

void cpu_watch(struct cpu *cpu, uint32_t address, bool on) {
    const uint32_t place = (address & ~1U) - CPU_FLASH_BASE;
    if (place < CPU_FLASH_BYTES) {
        const uint32_t bit = UINT32_C(1) << (place / 2U % 32U);
        uint32_t *word = &cpu->watched[place / 64U];
        *word = on ? *word | bit : *word & ~bit;
        cpu->blocks[place / 2U].size_bytes = 0;
    }
}

void cpu_hang(struct cpu *cpu, int from_priority) {
    cpu->hangs_from = from_priority;
    soc_alert(cpu->soc);
}

void cpu_reset(struct cpu *cpu) {
    uint32_t vectors[2] = {0, 0};
    (void)cpu_load(cpu, CPU_FLASH_BASE, vectors, sizeof vectors);
    const uint32_t xpsr_thumb = 0x01000000U, zero = 0, lr = 0xFFFFFFFFU;
    cpu->state = CPU_RUNS;
    cpu->hangs_from = NVIC_PRIORITY_THREAD + 1;
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_XPSR, &xpsr_thumb);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_CONTROL, &zero);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_PRIMASK, &zero);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_FAULTMASK, &zero);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_BASEPRI, &zero);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_LR, &lr);
    (void)uc_reg_write(cpu->engine, UC_ARM_REG_SP, &vectors[0]);
    cpu->pc = vectors[1] & ~1U;
    if ((vectors[1] & 1U) == 0U || vectors[0] - CPU_RAM_BASE > CPU_RAM_BYTES) {
        cpu_lock_up(cpu, "no reset vector: is the flash empty?", vectors[1]);
    }
}

// ---------------------------------------------------------------- set up

static bool map(struct cpu *cpu) {
    uc_engine *engine = cpu->engine;
    static const uintptr_t bases[] = {0x40000000U, 0xE0000000U};
    static const size_t sizes[] = {0x20000000U, 0x00100000U};
    bool mapped =
        uc_mem_map_ptr(engine, CPU_FLASH_BASE, CPU_FLASH_BYTES, UC_PROT_READ | UC_PROT_EXEC,
                       cpu->flash) == UC_ERR_OK &&
        uc_mem_map_ptr(engine, CPU_RAM_BASE, CPU_RAM_BYTES, UC_PROT_READ | UC_PROT_WRITE,
                       cpu->ram) == UC_ERR_OK &&
        uc_mem_map_ptr(engine, CPU_CCM_BASE, CPU_CCM_BYTES, UC_PROT_READ | UC_PROT_WRITE,
                       cpu->ccm) == UC_ERR_OK &&
        uc_mem_map_ptr(engine, SYSTEM_BASE, SYSTEM_BYTES, UC_PROT_READ, cpu->system) == UC_ERR_OK;
    for (unsigned i = 0; i < 2U; i++) {
        cpu->windows[i][0] = cpu;
        cpu->windows[i][1] = (void *)bases[i];
        mapped = mapped && uc_mmio_map(engine, bases[i], sizes[i], on_read, cpu->windows[i],
                                       on_write, cpu->windows[i]) == UC_ERR_OK;
    }
    return mapped;
}

static bool hook(struct cpu *cpu, int type, void *function) {
    uc_hook handle;
    return uc_hook_add(cpu->engine, &handle, type, function, cpu, (uint64_t)1, (uint64_t)0) ==
           UC_ERR_OK;
}

static uint8_t *new_memory(size_t size_bytes, int fill) {
    uint8_t *bytes = aligned_alloc(4096, size_bytes);
    if (bytes != NULL) {
        memset(bytes, fill, size_bytes);
    }
    return bytes;
}

bool cpu_init(struct cpu *cpu, struct soc *soc, bool exact) {
    memset(cpu, 0, sizeof *cpu);
    cpu->soc = soc;
    cpu->exact = exact;
    cpu->flash = new_memory(CPU_FLASH_BYTES, 0xFF);
    cpu->ram = new_memory(CPU_RAM_BYTES, 0xA5); // memory holds anything at power-on
    cpu->ccm = new_memory(CPU_CCM_BYTES, 0x5A);
    cpu->system = new_memory(SYSTEM_BYTES, 0xFF);
    cpu->blocks = calloc(CPU_FLASH_BYTES / 2U, sizeof *cpu->blocks);
    uc_engine *engine = NULL;
    if (cpu->flash == NULL || cpu->ram == NULL || cpu->ccm == NULL || cpu->system == NULL ||
        cpu->blocks == NULL ||
        uc_open(UC_ARCH_ARM, (uc_mode)(UC_MODE_THUMB | UC_MODE_MCLASS), &engine) != UC_ERR_OK) {
        cpu_free(cpu);
        return false;
    }
    cpu->engine = engine;
    static const uint16_t flash_kib = 1024;
    memcpy(cpu->system + (0x1FFF7A22U - SYSTEM_BASE), &flash_kib, sizeof flash_kib);
    const bool ready = uc_ctl_set_cpu_model(engine, UC_CPU_ARM_CORTEX_M4) == UC_ERR_OK &&
                       map(cpu) && hook(cpu, UC_HOOK_BLOCK, (void *)on_block) &&
                       hook(cpu, UC_HOOK_INTR, (void *)on_interrupt) &&
                       hook(cpu, UC_HOOK_MEM_INVALID, (void *)on_bad_access) &&
                       (!exact || hook(cpu, UC_HOOK_CODE, (void *)on_instruction));
    if (!ready) {
        cpu_free(cpu);
    }
    return ready;
}

void cpu_free(struct cpu *cpu) {
    if (cpu->engine != NULL) {
        (void)uc_close(cpu->engine);
    }
    free(cpu->flash);
    free(cpu->ram);
    free(cpu->ccm);
    free(cpu->system);
    free(cpu->blocks);
    memset(cpu, 0, sizeof *cpu);
}

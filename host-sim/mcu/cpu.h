/// The processor: a Cortex-M4 (no floating point) that runs machine code by libunicorn, with
/// exceptions of our own.
///
/// libunicorn knows instructions; entry to and return from exceptions, sleep, faults and lock-up
/// are here, from the ARMv7-M Architecture Reference Manual, B1.5. An instruction takes one cycle,
/// an exception's entry 12 and its return 10 (6 from one to the next): an idea of the speed, no
/// measurement. Time and interrupts are looked at between basic blocks (runs of instructions
/// without a jump), so an interrupt comes a few instructions late, and all register accesses in a
/// block happen at its end. A fault's frame has the address of the block's beginning, unless
/// `exact` was asked for (about four times slower). Not caught, though a real processor would:
/// unaligned LDM and STM, division by zero with its trap on, floating-point instructions while the
/// unit is off. Address 0 is not mapped, so that a null pointer faults (a real chip shows the flash
/// there). Shown: tests/mcu/cpu/exceptions.c; against QEMU's processor:
/// tests/mcu/cpu/second_opinion.sh.
#ifndef MCU_CPU_H
#define MCU_CPU_H

#include "mcu/soc.h"

#include <stdbool.h>
#include <stdint.h>

#define CPU_FLASH_BASE  0x08000000U
#define CPU_FLASH_BYTES 0x00100000U
#define CPU_RAM_BASE    0x20000000U
#define CPU_RAM_BYTES   0x00020000U
#define CPU_CCM_BASE    0x10000000U
#define CPU_CCM_BYTES   0x00010000U

enum cpu_state {
    CPU_RUNS,
    CPU_SLEEPS,
    CPU_LOCKED_UP, ///< a fault where no fault can be taken; only a reset helps
};

struct cpu;
/// The instruction at a watched address is about to run.
typedef void cpu_watch_fn(void *context, struct cpu *cpu, uint32_t address);

/// What is known of the basic block that begins at a half word of the flash.
struct cpu_block {
    uint16_t size_bytes; ///< 0: not known yet, or watched
    uint16_t instructions;
};

struct cpu {
    struct soc *soc;
    void *engine;        ///< of libunicorn
    void *windows[2][2]; ///< for its callbacks: this, and the first address of registers
    uint8_t *flash, *ram, *ccm, *system;
    struct cpu_block *blocks;
    uint32_t watched[CPU_FLASH_BYTES / 64U]; ///< a bit for each half word of the flash
    enum cpu_state state;
    bool waits_for_event; ///< sleeps in WFE, not WFI
    char why_locked_up[96];
    bool exact;
    uint32_t pc; ///< while nothing runs: where to go on
    bool stopping;
    uint32_t block_address, block_bytes; ///< the last that began
    uint32_t exact_pc; ///< with `exact`: of the instruction that runs, and how many have run
    uint64_t stepped;
    uint32_t fault_address;

    uint64_t other_cycles; ///< awake, but not for an instruction: exceptions' entry, hanging
    uint64_t handler_instructions; ///< since power-on, in exceptions that have ended
    uint64_t handler_from;         ///< instructions when the outermost exception began
    uint64_t exceptions;           ///< taken since power-on
    uint64_t resets;

    cpu_watch_fn *watcher;
    void *watcher_context;

    /// Code that runs at this group priority or a lower one (a higher number) makes no headway: a
    /// program that hangs. NVIC_PRIORITY_THREAD: everything but handlers; above: nothing. See
    /// cpu_hang.
    int hangs_from;
};

/// False: no memory, or libunicorn does not start.
bool cpu_init(struct cpu *cpu, struct soc *soc, bool exact);
void cpu_free(struct cpu *cpu);

/// Starts at the reset vector. Memory stays as it is.
void cpu_reset(struct cpu *cpu);

/// Runs until a time since power-on, at most 100 s ahead, and up to one basic block farther.
/// Carries out resets on the way.
void cpu_run(struct cpu *cpu, uint64_t until_ns);

/// From now on the watcher is (not) called for this address, which must be in the flash and the
/// target of a call, a jump or a return.
void cpu_watch(struct cpu *cpu, uint32_t address, bool on);

/// Instructions since power-on. An instruction is a cycle, and what else takes cycles is kept
/// apart.
static inline uint64_t cpu_instructions(const struct cpu *cpu) {
    return cpu->soc->cycle - cpu->soc->slept_cycles - cpu->other_cycles;
}

/// From now on nothing at this group priority or lower makes headway; until the next reset.
void cpu_hang(struct cpu *cpu, int from_priority);

/// Core registers R0 to R12, 13 (SP), 14 (LR) and 15 (PC); only from a watcher or between runs.
uint32_t cpu_register(struct cpu *cpu, unsigned number);

/// Flash and memory; false: part of it is somewhere else.
bool cpu_load(const struct cpu *cpu, uint32_t address, void *to, uint32_t size_bytes);
bool cpu_store(struct cpu *cpu, uint32_t address, const void *from, uint32_t size_bytes);

// ---------------------------------------------------------------- for the files of the model

/// Takes an exception that is pending, if it may go now. pc: of the next instruction.
bool cpu_take_pending(struct cpu *cpu, uint32_t pc);
/// An exception that an instruction caused; becomes a hard fault, or a lock-up, if it can't be
/// taken.
void cpu_raise(struct cpu *cpu, unsigned exception, uint32_t pc);
/// A return from an exception: exc_return is what was written to PC.
void cpu_return(struct cpu *cpu, uint32_t exc_return);
void cpu_lock_up(struct cpu *cpu, const char *why, uint32_t value);
struct nvic_masks cpu_masks(const struct cpu *cpu);
void cpu_spend(struct cpu *cpu, uint64_t cycles);

#endif

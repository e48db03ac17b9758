/// Looks into a running image, as a debugger does: at each call of controller_step it reads what
/// went in, and at its return what came out, from the image's memory. The image is not changed for
/// that.
///
/// It also hands target updates and commands in: into the input of the call, where the pump would
/// have put them had they come over a wire. That is the way to feed an image that has no host link
/// yet, or more than a serial line can carry. And it counts: instructions of the call without those
/// of interrupts, and of all that the program does between two calls (the loop, interrupts
/// included; asleep there are none). Shown: tests/mcu/cpu/board.c.
#ifndef MCU_PROBE_H
#define MCU_PROBE_H

#include "control/controller.h"
#include "mcu/cpu.h"
#include "mcu/image.h"

/// As many as a pump takes.
#define PROBE_UPDATES_MAX 128U

/// A call that has returned.
struct probe_tick {
    struct controller_input input;
    struct controller_output output;
    bool powered[AXIS_COUNT], ever_powered[AXIS_COUNT];
    uint32_t config_address; ///< of the controller's settings
    uint64_t step_instructions, loop_instructions;
};

struct probe_counts {
    uint64_t ticks;
    uint64_t step_sum, step_max;
    uint64_t loop_sum, loop_max;
};

/// Where things lie in the image's structures, and how long these are.
struct probe_offsets {
    uint32_t input_bytes, now_us, commands, pan_set, pan, frame_count, update_count, frame,
        frame_us, update, update_bytes;
    uint32_t output_bytes;
    uint32_t config, powered, ever_powered;
};

struct probe {
    struct cpu *cpu;
    struct probe_offsets offsets;
    uint32_t step_address;
    // Inside of a call.
    bool inside;
    uint32_t controller_at, output_at, return_to, stack;
    uint64_t step_from, handlers_from, loop_from;
    uint64_t seen_resets;
    struct probe_tick tick;
    // Waiting to go in.
    struct target_update update[PROBE_UPDATES_MAX];
    uint32_t first, count, commands;
    bool pan_set;
    struct controller_pan pan;
    struct probe_counts counts;
    /// After each call. started: the first one since a reset.
    void (*stepped)(void *context, const struct probe_tick *tick, bool started);
    void *context;
    bool started;
};

/// Watches an image. False: it has no function controller_step (it is something else, or stripped).
bool probe_init(struct probe *probe, struct cpu *cpu, const struct image *image);

/// For the next call. False: too many wait.
bool probe_push(struct probe *probe, const struct target_update *update);
void probe_command(struct probe *probe, uint32_t commands);
void probe_pan(struct probe *probe, const struct controller_pan *pan);

/// Settings of the controller, out of the image's memory. False: they are not there.
bool probe_config(const struct cpu *cpu, uint32_t address, struct controller_config *config);

/// Forgets the counts.
void probe_restart_counts(struct probe *probe);

#endif

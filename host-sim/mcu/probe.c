#include "mcu/probe.h"

#include "replay/layout.h"

#include <string.h>

#define INPUT_BYTES_MAX  8192U
#define OUTPUT_BYTES_MAX 1024U
#define CONFIG_BYTES_MAX 1024U

// ---------------------------------------------------------------- going in

/// Puts what waits into the input of the call that begins.
static void hand_in(struct probe *probe, uint32_t input_at, uint8_t *arm) {
    const struct probe_offsets *at = &probe->offsets;
    uint32_t count, commands;
    memcpy(&count, arm + at->update_count, sizeof count);
    memcpy(&commands, arm + at->commands, sizeof commands);
    commands |= probe->commands;
    probe->commands = 0;
    while (probe->count != 0U && count < CONTROLLER_UPDATES_MAX) {
        layout_to_arm(&layout_target_update, &probe->update[probe->first],
                      arm + at->update + count * at->update_bytes);
        probe->first = (probe->first + 1U) % PROBE_UPDATES_MAX;
        probe->count--;
        count++;
    }
    if (probe->pan_set) {
        const bool set = true;
        memcpy(arm + at->pan_set, &set, sizeof set);
        layout_to_arm(&layout_controller_pan, &probe->pan, arm + at->pan);
        probe->pan_set = false;
    }
    memcpy(arm + at->update_count, &count, sizeof count);
    memcpy(arm + at->commands, &commands, sizeof commands);
    (void)cpu_store(probe->cpu, input_at, arm, at->update + count * at->update_bytes);
}

/// Only as much as is used: the structure is large and this is done a thousand times a second.
static void read_input(struct probe *probe, const uint8_t *arm) {
    struct controller_input *input = &probe->tick.input;
    const struct probe_offsets *at = &probe->offsets;
    memcpy(&input->now_us, arm + at->now_us, sizeof input->now_us);
    memcpy(&input->commands, arm + at->commands, sizeof input->commands);
    memcpy(&input->pan_set, arm + at->pan_set, sizeof input->pan_set);
    layout_to_host(&layout_controller_pan, arm + at->pan, &input->pan);
    memcpy(&input->frame_count, arm + at->frame_count, sizeof input->frame_count);
    memcpy(&input->update_count, arm + at->update_count, sizeof input->update_count);
    const uint32_t frames = input->frame_count < CONTROLLER_FRAMES_IN_MAX
                                ? input->frame_count
                                : CONTROLLER_FRAMES_IN_MAX;
    memcpy(input->frame, arm + at->frame, frames * sizeof input->frame[0]);
    memcpy(input->frame_us, arm + at->frame_us, frames * sizeof input->frame_us[0]);
    for (uint32_t i = 0; i < input->update_count && i < CONTROLLER_UPDATES_MAX; i++) {
        layout_to_host(&layout_target_update, arm + at->update + i * at->update_bytes,
                       &input->update[i]);
    }
}

static void begin_call(struct probe *probe) {
    struct cpu *cpu = probe->cpu;
    uint8_t arm[INPUT_BYTES_MAX];
    const uint32_t input_at = cpu_register(cpu, 1);
    if (!cpu_load(cpu, input_at, arm, probe->offsets.input_bytes)) {
        return; // nonsense: the processor will find out by itself
    }
    hand_in(probe, input_at, arm);
    read_input(probe, arm);
    probe->controller_at = cpu_register(cpu, 0);
    probe->output_at = cpu_register(cpu, 2);
    probe->stack = cpu_register(cpu, 13);
    probe->return_to = cpu_register(cpu, 14) & ~1U;
    probe->step_from = cpu_instructions(cpu);
    probe->handlers_from = cpu->handler_instructions;
    probe->tick.loop_instructions = cpu_instructions(cpu) - probe->loop_from;
    probe->loop_from = cpu_instructions(cpu);
    probe->inside = true;
    cpu_watch(cpu, probe->return_to, true);
}

// ---------------------------------------------------------------- coming out

static void read_output(struct probe *probe) {
    const struct cpu *cpu = probe->cpu;
    struct probe_tick *tick = &probe->tick;
    uint8_t arm[OUTPUT_BYTES_MAX];
    if (cpu_load(cpu, probe->output_at, arm, probe->offsets.output_bytes)) {
        layout_to_host(&layout_controller_output, arm, &tick->output);
    }
    const uint32_t at = probe->controller_at;
    (void)cpu_load(cpu, at + probe->offsets.powered, tick->powered, sizeof tick->powered);
    (void)cpu_load(cpu, at + probe->offsets.ever_powered, tick->ever_powered,
                   sizeof tick->ever_powered);
    (void)cpu_load(cpu, at + probe->offsets.config, &tick->config_address,
                   sizeof tick->config_address);
}

static void count(struct probe *probe) {
    struct probe_counts *counts = &probe->counts;
    const struct probe_tick *tick = &probe->tick;
    counts->step_sum += tick->step_instructions;
    counts->step_max =
        tick->step_instructions > counts->step_max ? tick->step_instructions : counts->step_max;
    counts->ticks++;
    if (probe->started) { // before the first call lies the start of the program
        counts->loop_sum += tick->loop_instructions;
        counts->loop_max =
            tick->loop_instructions > counts->loop_max ? tick->loop_instructions : counts->loop_max;
    }
}

static void end_call(struct probe *probe) {
    struct cpu *cpu = probe->cpu;
    probe->inside = false;
    cpu_watch(cpu, probe->return_to, false);
    probe->tick.step_instructions = (cpu_instructions(cpu) - probe->step_from) -
                                    (cpu->handler_instructions - probe->handlers_from);
    read_output(probe);
    count(probe);
    const bool started = !probe->started;
    probe->started = true;
    if (probe->stepped != NULL) {
        probe->stepped(probe->context, &probe->tick, started);
    }
}

static void on_watched(void *context, struct cpu *cpu, uint32_t address) {
    struct probe *probe = context;
    if (cpu->resets != probe->seen_resets) {
        probe->seen_resets = cpu->resets;
        probe->inside = probe->started = false;
    }
    if (address == probe->step_address) {
        begin_call(probe);
    } else if (probe->inside && address == probe->return_to &&
               cpu_register(cpu, 13) == probe->stack) {
        end_call(probe);
    }
}

// ---------------------------------------------------------------- use

static struct probe_offsets find_offsets(void) {
    struct layout *input = &layout_controller_input, *controller = &layout_controller;
    return (struct probe_offsets){
        .input_bytes = layout_arm_bytes(input),
        .now_us = layout_arm_offset(input, "now_us"),
        .commands = layout_arm_offset(input, "commands"),
        .pan_set = layout_arm_offset(input, "pan_set"),
        .pan = layout_arm_offset(input, "pan"),
        .frame_count = layout_arm_offset(input, "frame_count"),
        .update_count = layout_arm_offset(input, "update_count"),
        .frame = layout_arm_offset(input, "frame"),
        .frame_us = layout_arm_offset(input, "frame_us"),
        .update = layout_arm_offset(input, "update"),
        .update_bytes = layout_arm_bytes(&layout_target_update),
        .output_bytes = layout_arm_bytes(&layout_controller_output),
        .config = layout_arm_offset(controller, "config"),
        .powered = layout_arm_offset(controller, "powered"),
        .ever_powered = layout_arm_offset(controller, "ever_powered"),
    };
}

bool probe_init(struct probe *probe, struct cpu *cpu, const struct image *image) {
    struct image_symbol symbol;
    memset(probe, 0, sizeof *probe);
    if (!image_symbol(image, "controller_step", &symbol)) {
        return false;
    }
    probe->cpu = cpu;
    probe->offsets = find_offsets();
    probe->step_address = symbol.address & ~1U;
    cpu->watcher = on_watched;
    cpu->watcher_context = probe;
    cpu_watch(cpu, probe->step_address, true);
    return true;
}

bool probe_push(struct probe *probe, const struct target_update *update) {
    if (probe->count == PROBE_UPDATES_MAX) {
        return false;
    }
    probe->update[(probe->first + probe->count++) % PROBE_UPDATES_MAX] = *update;
    return true;
}

void probe_command(struct probe *probe, uint32_t commands) {
    probe->commands |= commands;
}

void probe_pan(struct probe *probe, const struct controller_pan *pan) {
    probe->pan = *pan;
    probe->pan_set = true;
}

bool probe_config(const struct cpu *cpu, uint32_t address, struct controller_config *config) {
    uint8_t arm[CONFIG_BYTES_MAX];
    if (!cpu_load(cpu, address, arm, layout_arm_bytes(&layout_controller_config))) {
        return false;
    }
    layout_to_host(&layout_controller_config, arm, config);
    return true;
}

void probe_restart_counts(struct probe *probe) {
    probe->counts = (struct probe_counts){0};
}

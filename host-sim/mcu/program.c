/// What the program boresight-mcu has that `boresight` lacks: the emulated microcontroller. It is a
/// program of its own because libunicorn is under the GPL.
#include "emulator.h"

#include "mcu/mcu_board.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define CYCLES_PER_TICK 168000.0

struct handle {
    struct mcu_board board;
    FILE *console;
    struct serial_pty serial;
    bool has_serial;
};

static void close_board(void *handle_of) {
    struct handle *handle = handle_of;
    mcu_board_free(&handle->board);
    if (handle->has_serial) {
        serial_pty_close(&handle->serial);
    }
    if (handle->console != NULL && handle->console != stderr) {
        fclose(handle->console);
    }
    free(handle);
}

static enum exit_status read_options(const struct emulator_options *options, struct handle *handle,
                                     struct mcu_board_options *board) {
    *board = (struct mcu_board_options){.image = options->image, .log = stderr};
    const char *wrong =
        options->faults != NULL ? mcu_board_read_faults(options->faults, board) : NULL;
    if (wrong != NULL) {
        message_command("sim", "--mcu-faults %s: %s; there are: %s",
                        message_quoted(options->faults, strlen(options->faults)).text, wrong,
                        mcu_board_fault_names());
        return EXIT_STATUS_USAGE;
    }
    if (options->console != NULL) {
        handle->console =
            strcmp(options->console, "-") == 0 ? stderr : fopen(options->console, "w");
        if (handle->console == NULL) {
            message_at(options->console, 0, "%s", strerror(errno));
            return EXIT_STATUS_USAGE;
        }
        board->console = handle->console;
    }
    if (options->serial != NULL) {
        handle->has_serial = serial_pty_open(&handle->serial, options->serial);
        if (!handle->has_serial) {
            message_at(options->serial, 0, "%s", strerror(errno));
            return EXIT_STATUS_USAGE;
        }
        board->serial = &handle->serial;
    }
    return EXIT_STATUS_OK;
}

static enum exit_status start(const struct emulator_options *options,
                              const struct controller_config *rig, struct handle *handle) {
    struct mcu_board_options board;
    const enum exit_status status = read_options(options, handle, &board);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    const char *wrong = mcu_board_start(&handle->board, &board);
    if (wrong != NULL) {
        message_at(options->image, 0, "%s", wrong);
        return EXIT_STATUS_USAGE;
    }
    const char *differs = mcu_board_other_rig(&handle->board, rig);
    if (differs != NULL) {
        message_at(options->image, 0, "is built for another rig: its '%s' differs", differs);
        return EXIT_STATUS_USAGE;
    }
    return EXIT_STATUS_OK;
}

static enum exit_status open_board(const struct emulator_options *options,
                                   const struct controller_config *rig,
                                   const struct sim_board **board, void **handle_of) {
    struct handle *handle = calloc(1, sizeof *handle);
    if (handle == NULL) {
        message_command("sim", "no memory for the board");
        return EXIT_STATUS_FAILURE;
    }
    const enum exit_status status = start(options, rig, handle);
    if (status != EXIT_STATUS_OK) {
        close_board(handle);
        return status;
    }
    *board = &handle->board.board;
    *handle_of = handle;
    return EXIT_STATUS_OK;
}

static void print_facts(void *handle_of, struct facts *facts) {
    const struct mcu_board *board = &((struct handle *)handle_of)->board;
    const struct probe_counts *counts = &board->probe.counts;
    const uint64_t ticks = counts->ticks != 0U ? counts->ticks : 1U;
    facts_text(facts, "mcu", "stm32f405");
    facts_u64(facts, "mcu_steps", counts->ticks);
    facts_u64(facts, "mcu_resets", board->machine.cpu.resets);
    facts_u64(facts, "mcu_complaints", board->machine.soc.complaints);
    facts_u64(facts, "mcu_step_mean", counts->step_sum / ticks);
    facts_u64(facts, "mcu_step_max", counts->step_max);
    facts_u64(facts, "mcu_loop_mean", counts->loop_sum / ticks);
    facts_u64(facts, "mcu_loop_max", counts->loop_max);
    facts_fixed(facts, "mcu_loop_percent", 100.0 * (double)counts->loop_max / CYCLES_PER_TICK, 1);
    facts_text(facts, "mcu_says", board->last_line);
}

static uint64_t faults_injected(void *handle_of) {
    const struct mcu_board *board = &((struct handle *)handle_of)->board;
    return (uint64_t)__builtin_popcount(board->faults_done);
}

static bool is_sound(void *handle_of) {
    const struct soc *soc = &((struct handle *)handle_of)->board.machine.soc;
    if (soc->complaints != 0U) {
        message_command("sim", "the image did what the chip's manual forbids: %s",
                        soc->complaint[0]);
    }
    return soc->complaints == 0U;
}

static const struct emulator here = {.fault_names = mcu_board_fault_names,
                                     .open = open_board,
                                     .facts = print_facts,
                                     .faults_injected = faults_injected,
                                     .is_sound = is_sound,
                                     .close = close_board};
const struct emulator *const emulator = &here;

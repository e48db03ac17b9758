/// The simulator's drives behind a CAN adapter of the slcan kind, on a pseudo-terminal, in real
/// time: for programs that drive a rig by `bus = slcan:LINK` where the kernel has no CAN.
///
/// Usage: pty_drives RIG.ini LINK
/// LINK becomes a symbolic link to the terminal. Ends by SIGTERM, or after ten minutes. Where it
/// may, it has real-time priority above that of `boresight run`: the drives are what is measured
/// by.
#include "rig.h"
#include "sim.h"

#include "event_loop.h"

#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

enum { LIFE_S = 600, CATCH_UP_TICKS = 1000 };

static int terminal;

// ---------------------------------------------------------------- the adapter

static void answer(const char *text) {
    (void)!write(terminal, text, strlen(text)); // nobody listens: as on a wire
}

static enum hal_status drives_send(void *ctx, const struct can_frame *frame) {
    char line[40];
    (void)ctx;
    int size = snprintf(line, sizeof line, "t%03X%u", (unsigned)frame->id, frame->length);
    for (unsigned i = 0; i < frame->length; i++) {
        size += snprintf(line + size, sizeof line - (size_t)size, "%02X", frame->data[i]);
    }
    snprintf(line + size, sizeof line - (size_t)size, "\r");
    answer(line);
    return HAL_OK;
}

static unsigned hex(const char *text, unsigned digits) {
    char copy[9];
    snprintf(copy, sizeof copy, "%.*s", (int)digits, text);
    return (unsigned)strtoul(copy, NULL, 16);
}

/// A command. True: it was a frame.
static bool obey(const char *line, struct can_frame *frame) {
    if (line[0] != 't' || strlen(line) < 5U) {
        answer(line[0] == 'F' ? "F00\r" : line[0] == 'V' ? "V1013\r" : "\r");
        return false;
    }
    *frame = (struct can_frame){.id = hex(line + 1, 3), .length = (uint8_t)hex(line + 4, 1)};
    for (unsigned i = 0; i < frame->length && i < 8U; i++) {
        frame->data[i] = (uint8_t)hex(line + 5 + 2U * i, 2);
    }
    answer("z\r");
    return true;
}

static enum hal_status drives_receive(void *ctx, struct can_frame *frame, uint32_t *at_us) {
    static char line[64];
    static size_t size;
    char byte;
    (void)ctx;
    while (read(terminal, &byte, 1) == 1) {
        if (byte != '\r') {
            line[size] = byte;
            size += size < sizeof line - 1U;
            continue;
        }
        line[size] = '\0';
        size = 0;
        if (obey(line, frame)) {
            *at_us = 0;
            return HAL_OK;
        }
    }
    return HAL_EMPTY;
}

static enum hal_status drives_state(void *ctx, struct hal_can_state *state) {
    (void)ctx;
    *state = (struct hal_can_state){.health = HAL_CAN_ACTIVE};
    return HAL_OK;
}

static enum hal_status drives_filters(void *ctx, const struct hal_can_filter *filters,
                                      uint32_t count) {
    (void)ctx;
    (void)filters;
    (void)count;
    return HAL_OK;
}

static enum hal_status drives_restart(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static bool open_terminal(const char *link) {
    struct termios raw;
    terminal = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (terminal < 0 || grantpt(terminal) != 0 || unlockpt(terminal) != 0) {
        return false;
    }
    const char *const name = ptsname(terminal);
    const int end = open(name, O_RDWR | O_NOCTTY); // stays open: no hang-up between programs
    if (end < 0 || tcgetattr(end, &raw) != 0) {
        return false;
    }
    cfmakeraw(&raw);
    return tcsetattr(end, TCSANOW, &raw) == 0 && symlink(name, link) == 0;
}

// ---------------------------------------------------------------- in real time

int main(int argc, char **argv) {
    static const struct hal_can_ops ops = {drives_send, drives_receive, drives_state,
                                           drives_filters, drives_restart};
    static struct schedule nothing;
    struct rig rig;
    struct hal_can outside;
    struct event_loop loop;
    if (argc != 3 || rig_read(argv[1], 0, &rig) != EXIT_STATUS_OK ||
        hal_can_bind(&outside, &ops, NULL) != HAL_OK || !open_terminal(argv[2])) {
        fprintf(stderr, "pty_drives RIG.ini LINK\n");
        return 2;
    }
    const struct sim_config config = {
        .controller = &rig.controller, .schedule = &nothing, .seed = 1};
    struct sim *const sim = sim_create(&config);
    const struct sched_param wanted = {.sched_priority = 40};
    (void)sched_setscheduler(0, SCHED_FIFO, &wanted);
    if (sim == NULL || !event_loop_open(&loop, rig.controller.tick_us)) {
        return 1;
    }
    uint32_t raised = 0;
    while ((raised & EVENT_LOOP_END) == 0U && sim->time_us < LIFE_S * UINT64_C(1000000)) {
        uint64_t due = event_loop_tick(&loop, &raised);
        due = due > CATCH_UP_TICKS ? CATCH_UP_TICKS : due;
        for (uint64_t i = 0; i < due; i++) {
            sim_serve_step(sim, &outside);
        }
    }
    event_loop_close(&loop);
    sim_destroy(sim);
    rig_free(&rig);
    return 0;
}

/// An image on the emulated board, in the closed loop with the simulator, for the programs of this
/// folder: they begin with one, step `sim`, look at `board`, read what the console said, and
/// finish.
#ifndef TESTS_MCU_CPU_CLOSED_LOOP_H
#define TESTS_MCU_CPU_CLOSED_LOOP_H

#include "check.h"

#include "mcu/mcu_board.h"
#include "scenario.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct scenario scenario;
static struct mcu_board board;
static struct sim *sim; ///< NULL: it could not begin
static FILE *console;
static char *said; ///< behind fflush(console)
static size_t said_bytes;

/// options: all but the console.
static inline bool begin_loop(struct mcu_board_options options, const char *scenario_file) {
    console = open_memstream(&said, &said_bytes);
    options.console = console;
    sim = NULL;
    const char *wrong = mcu_board_start(&board, &options);
    if (wrong != NULL) {
        printf("  %s: %s\n", options.image, wrong);
    }
    if (CHECK(wrong == NULL) && CHECK(scenario_read(scenario_file, &scenario) == EXIT_STATUS_OK)) {
        scenario.sim.board = &board.board;
        sim = sim_create(&scenario.sim);
    }
    return CHECK(sim != NULL);
}

static inline void run_ms(unsigned ms) {
    for (unsigned i = 0; i < ms; i++) {
        sim_step(sim);
    }
}

static inline bool says(const char *words) {
    fflush(console);
    return said != NULL && strstr(said, words) != NULL;
}

/// Checks what holds in every run: the invariants, the manual, a console that can be read.
static inline void finish(void) {
    if (sim != NULL) {
        CHECK_EQ(sim_violation_count(&sim->violations), 0);
        if (sim->violations.first[0] != '\0') {
            printf("  # %s\n", sim->violations.first);
        }
        CHECK_EQ(board.machine.soc.complaints, 0);
        if (board.machine.soc.complaints != 0U) {
            printf("  # %s\n", board.machine.soc.complaint[0]);
        }
        CHECK_EQ(board.garbled, 0);
    }
    if (console != NULL && fclose(console) == 0 && !check_clean()) {
        printf("%s", said);
    }
    console = NULL;
    sim_destroy(sim);
    scenario_free(&scenario);
    mcu_board_free(&board);
    free(said);
    said = NULL;
}

// ---------------------------------------------------------------- a person at the serial line

static struct serial_pty serial;

static inline bool begin_typing(const char *image, const char *scenario_file) {
    char link_path[] = "/tmp/boresight-typing-XXXXXX";
    const int handle = mkstemp(link_path); // a name; the link takes its place
    if (handle >= 0) {
        close(handle);
        unlink(link_path);
    }
    if (!CHECK(serial_pty_open(&serial, link_path))) {
        return false;
    }
    return begin_loop((struct mcu_board_options){.image = image, .serial = &serial}, scenario_file);
}

static inline void finish_typing(void) {
    finish();
    serial_pty_close(&serial);
}

/// Types a line, and gives the board time to do what it says and to answer.
static inline void type(const char *line, unsigned ms) {
    CHECK(write(serial.other_end, line, strlen(line)) == (ssize_t)strlen(line));
    run_ms(ms);
    fflush(console);
}

/// What it said last after these words, up to the end of the line.
static inline const char *last(const char *words) {
    const char *found = NULL;
    for (const char *at = said; at != NULL && (at = strstr(at, words)) != NULL; at++) {
        found = at;
    }
    return found != NULL ? found + strlen(words) : "";
}

static inline bool says_last(const char *words, const char *wanted) {
    return strncmp(last(words), wanted, strlen(wanted)) == 0;
}

#endif

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

#endif

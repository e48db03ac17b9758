#include "greeting.h"

#include "cortexm/cortexm_crash.h"
#include "link/text.h"

#include <stddef.h>

#define EXCEPTION_NMI 2U

static void finish(struct text *text) {
    text->buffer[text->size_bytes] = '\0';
}

void greeting_init(struct greeting *greeting, const char *board) {
    *greeting = (struct greeting){.notes = {board, NULL}};
}

void greeting_clock(struct greeting *greeting, uint32_t core_hz, const char *state,
                    const char *more) {
    struct text text;
    text_begin(&text, greeting->clock, sizeof greeting->clock - 1U);
    text_string(&text, "clock: ");
    text_unsigned(&text, core_hz / 1000000U, 0);
    text_string(&text, " MHz, ");
    text_string(&text, state);
    text_string(&text, more);
    finish(&text);
    greeting->notes[1] = greeting->clock;
}

void greeting_crash(struct greeting *greeting, const char *nmi) {
    struct cortexm_crash crash;
    if (!cortexm_crash_take(&crash)) {
        return;
    }
    struct text text;
    text_begin(&text, greeting->crash, sizeof greeting->crash - 1U);
    text_string(&text, "last run: ");
    text_string(&text, crash.exception == EXCEPTION_NMI && nmi != NULL
                           ? nmi
                           : cortexm_crash_name(crash.exception));
    text_string(&text, " ");
    text_unsigned(&text, crash.exception, 0);
    text_string(&text, " at ");
    text_hex(&text, crash.pc);
    text_string(&text, " from ");
    text_hex(&text, crash.lr);
    finish(&text);
    greeting->notes[2] = greeting->crash;
}

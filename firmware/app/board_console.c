#include "app/board_console.h"

#include "link/text.h"

#define PERIOD_US 1000000U

void board_console_init(struct board_console *console, const struct hal_serial *serial,
                        const char *const *notes) {
    *console = (struct board_console){.serial = serial, .notes = notes};
}

static const char *cause_name(enum hal_reset_cause cause) {
    static const char *const names[] = {"not told",  "power-on", "brown-out",
                                        "reset pin", "software", "watchdog"};
    return names[cause];
}

static const char *health_name(enum hal_can_health health) {
    static const char *const names[] = {"active", "passive", "off"};
    return names[health];
}

// ---------------------------------------------------------------- lines

/// The lines of the greeting, one a call. False: all told.
static bool write_greeting(struct board_console *console, const struct board_status *status,
                           struct text *text) {
    if (!console->greeted) {
        console->greeted = true;
        text_string(text, "boresight ");
        text_string(text, build_id);
    } else if (console->notes[console->notes_told] != NULL) {
        text_string(text, console->notes[console->notes_told++]);
    } else if (!console->cause_told) {
        console->cause_told = true;
        text_string(text, "reset: ");
        text_string(text, cause_name(status->reset_cause));
    } else if (!console->refusal_told && status->refusal != NULL) {
        console->refusal_told = true;
        text_string(text, "will not arm: ");
        text_string(text, status->refusal);
    } else {
        return false;
    }
    return true;
}

static void write_axis(struct text *text, const char *name,
                       const struct controller_axis_status *axis) {
    text_string(text, name);
    text_hundredths(text, drive_cdeg_from_q48(axis->setpoint_q48), 8);
}

static void write_status(const struct board_console *console, const struct pump *pump,
                         const struct board_status *status, struct text *text) {
    const struct controller_status *controller = &pump->output.status;
    text_unsigned(text, console->seconds, 6);
    text_string(text, " s  ");
    text_string(text, controller_mode_name(controller->mode));
    write_axis(text, "  pan", &controller->axis[AXIS_PAN]);
    write_axis(text, "  tilt", &controller->axis[AXIS_TILT]);
    text_string(text, "  targets ");
    text_unsigned(text, controller->target_count, 0);
    if (pump->devices.can != NULL) {
        text_string(text, "  can ");
        text_string(text, health_name(status->can.health));
        text_string(text, " ");
        text_unsigned(text, status->can.transmit_error_count, 0);
        text_string(text, "/");
        text_unsigned(text, status->can.receive_error_count, 0);
    }
    text_string(text, "  busy ");
    text_unsigned(text, status->busy_us_max, 0);
    text_string(text, " us  missed ");
    text_unsigned(text, status->ticks_missed, 0);
    if (controller->faults != 0U) {
        text_string(text, "  fault: ");
        text_string(text, controller_fault_name(controller->faults));
    }
    if (status->refusal != NULL || status->stop != NULL) {
        text_string(text, "  held: ");
        text_string(text, status->refusal != NULL ? status->refusal : status->stop);
    }
}

/// The next line, when it is due.
static void write_line(struct board_console *console, const struct pump *pump,
                       struct board_status *status) {
    struct text text;
    text_begin(&text, console->line, sizeof console->line - 2U);
    if (!write_greeting(console, status, &text)) {
        if (hal_clock_span_us(console->told_us, pump->input.now_us) < PERIOD_US) {
            return;
        }
        console->told_us += PERIOD_US;
        console->seconds++;
        write_status(console, pump, status, &text);
        status->busy_us_max = 0;
        status->can = (struct hal_can_state){.health = HAL_CAN_ACTIVE};
    }
    console->line[text.size_bytes] = '\r';
    console->line[text.size_bytes + 1U] = '\n';
    console->size_bytes = text.size_bytes + 2U;
    console->sent_bytes = 0;
}

static void throw_input_away(const struct board_console *console) {
    uint8_t bytes[32];
    size_t count;
    (void)!hal_serial_read(console->serial, bytes, sizeof bytes, &count);
}

void board_console_poll(struct board_console *console, struct pump *pump,
                        struct board_status *status) {
    throw_input_away(console);
    if (console->sent_bytes == console->size_bytes) {
        write_line(console, pump, status);
    }
    if (console->sent_bytes < console->size_bytes) {
        size_t written;
        const uint8_t *rest = (const uint8_t *)&console->line[console->sent_bytes];
        (void)!hal_serial_write(console->serial, rest, console->size_bytes - console->sent_bytes,
                                &written);
        console->sent_bytes += (uint32_t)written;
    }
}

#include "app/board_console.h"

#include "app/settings_digest.h"

#define FIRST_TRACE_MS 1000U

void board_console_init(struct board_console *console, const struct hal_serial *serial,
                        const char *const *notes, struct pump *pump, struct board_status *status,
                        struct board_settings *settings) {
    console->serial = serial;
    console->notes = notes;
    console->pump = pump;
    console->status = status;
    console->settings = settings;
    console->commands = (struct board_commands){.pump = pump, .settings = settings};
    program_link_init(&console->link);
    line_splitter_init(&console->splitter);
    line_editor_init(&console->editor);
    console->now_us = console->traced_us = 0;
    console->last_us = hal_clock_now_us(pump->devices.clock);
    console->digest = settings_digest(settings->built);
    console->job = BOARD_CONSOLE_GREETING;
    console->job_line = 0;
    console->talks = console->asked = false;
    console->traces = true;
    console->trace_ms = FIRST_TRACE_MS;
    console->lost_lines = 0;
    console->in_count = console->in_at = console->out_first = console->out_count = 0;
}

// ---------------------------------------------------------------- out

static bool has_room(const struct board_console *console) {
    return BOARD_CONSOLE_OUT_BYTES - console->out_count >= BOARD_CONSOLE_LINE_BYTES;
}

/// All of it, or nothing.
static void put(struct board_console *console, const struct text *text) {
    if (BOARD_CONSOLE_OUT_BYTES - console->out_count < text->size_bytes) {
        console->lost_lines++;
        return;
    }
    uint32_t at = (console->out_first + console->out_count) % BOARD_CONSOLE_OUT_BYTES;
    for (uint32_t i = 0; i < text->size_bytes; i++) {
        console->out[at] = (uint8_t)text->buffer[i];
        at = at + 1U < BOARD_CONSOLE_OUT_BYTES ? at + 1U : 0U;
    }
    console->out_count += text->size_bytes;
}

static void flush(struct board_console *console) {
    while (console->out_count != 0U) {
        const uint32_t to_end = BOARD_CONSOLE_OUT_BYTES - console->out_first;
        const uint32_t size = console->out_count < to_end ? console->out_count : to_end;
        size_t written = 0;
        if (hal_serial_write(console->serial, &console->out[console->out_first], size, &written) !=
            HAL_OK) {
            return;
        }
        console->out_first = (console->out_first + (uint32_t)written) % BOARD_CONSOLE_OUT_BYTES;
        console->out_count -= (uint32_t)written;
        if (written < size) {
            return;
        }
    }
}

// ---------------------------------------------------------------- a person

static bool may(const struct board_console *console, enum request_kind kind) {
    return !console->link.owned || kind == REQUEST_STOP || kind == REQUEST_HELP ||
           kind == REQUEST_STATUS || kind == REQUEST_GET || kind == REQUEST_TRACE;
}

static void begin_job(struct board_console *console, enum board_console_job job) {
    console->job = job;
    console->job_line = 0;
}

static const char *serve(struct board_console *console, const struct request *request,
                         struct text *answer) {
    switch (request->kind) {
    case REQUEST_HELP:
        begin_job(console, BOARD_CONSOLE_HELP);
        return NULL;
    case REQUEST_STATUS:
        begin_job(console, BOARD_CONSOLE_STATUS);
        return NULL;
    case REQUEST_TRACE:
        console->traces = console->asked = request->on;
        console->trace_ms = request->period_ms;
        console->traced_us = console->now_us;
        return NULL;
    case REQUEST_GET:
        if (request->name.size_bytes == 0U) {
            begin_job(console, BOARD_CONSOLE_SETTINGS);
            return NULL;
        }
        break;
    default:
        break;
    }
    const char *held = board_status_held(console->status);
    return board_commands_do(&console->commands, request, held, answer);
}

static void take_line(struct board_console *console) {
    char buffer[BOARD_CONSOLE_LINE_BYTES];
    struct text answer;
    struct request request;
    const struct line_editor_text *line = &console->editor.line;
    text_begin(&answer, buffer, sizeof buffer);
    struct words words = words_of(line->text, line->size_bytes);
    if (words_at_end(&words)) {
        return;
    }
    const char *wrong = request_read(line->text, line->size_bytes, &request);
    if (wrong == NULL && !may(console, request.kind)) {
        wrong = "a program has the board: only stop, status, get, trace and help until it leaves";
    }
    if (wrong == NULL) {
        wrong = serve(console, &request, &answer);
    }
    if (wrong != NULL) {
        text_begin(&answer, buffer, sizeof buffer);
        text_string(&answer, "error: ");
        text_string(&answer, wrong);
    } else if (answer.size_bytes == 0U && console->job == BOARD_CONSOLE_QUIET) {
        text_string(&answer, "ok");
    }
    if (answer.size_bytes != 0U) {
        text_string(&answer, "\r\n");
        put(console, &answer);
    }
}

/// After Enter or Ctrl-C: what was typed is done with.
static void prompt(struct board_console *console) {
    char buffer[LINE_EDITOR_ECHO_BYTES];
    struct text text;
    text_begin(&text, buffer, sizeof buffer);
    if (console->job == BOARD_CONSOLE_QUIET) {
        line_editor_show(&console->editor, &text);
        put(console, &text);
    }
}

static void take_key(struct board_console *console, uint8_t key) {
    char buffer[LINE_EDITOR_ECHO_BYTES];
    struct text echo;
    text_begin(&echo, buffer, sizeof buffer);
    if (!console->talks) { // from here on it is a console
        console->talks = true;
        console->traces = console->asked;
        line_editor_show(&console->editor, &echo);
    }
    const enum line_editor_event event = line_editor_take(&console->editor, key, &echo);
    put(console, &echo);
    if (event == LINE_EDITOR_NOTHING) {
        return;
    }
    if (event == LINE_EDITOR_STOP) {
        pump_command(console->pump, COMMAND_STOP);
        begin_job(console, BOARD_CONSOLE_QUIET);
    } else {
        take_line(console);
    }
    line_editor_clear(&console->editor);
    prompt(console);
}

// ---------------------------------------------------------------- in

static struct program_link_board board_of(struct board_console *console) {
    return (struct program_link_board){.commands = &console->commands,
                                       .held = board_status_held(console->status),
                                       .digest = console->digest,
                                       .now_us = console->now_us};
}

static void take_checked_line(struct board_console *console) {
    char buffer[CHECKED_LINE_BYTES_MAX];
    struct text answer;
    text_begin(&answer, buffer, sizeof buffer);
    const struct program_link_board board = board_of(console);
    program_link_take(&console->link, &console->splitter.line, &board, &answer);
    put(console, &answer);
    console->traces = console->traces && (console->asked || !console->link.owned);
}

static bool next_byte(struct board_console *console, uint8_t *byte) {
    if (console->in_at == console->in_count) {
        size_t count = 0;
        console->in_at = console->in_count = 0;
        if (hal_serial_read(console->serial, console->in, sizeof console->in, &count) != HAL_OK) {
            return false;
        }
        console->in_count = (uint32_t)count;
    }
    *byte = console->in[console->in_at++];
    return true;
}

/// A line of targets is read in parts; what comes behind it waits.
static void read_input(struct board_console *console) {
    const struct program_link_board board = board_of(console);
    uint8_t byte;
    if (program_link_read_targets(&console->link, &board)) {
        return;
    }
    for (uint32_t i = 0; i < BOARD_CONSOLE_BYTES_A_TICK && next_byte(console, &byte); i++) {
        const enum line_splitter_event event = line_splitter_take(&console->splitter, byte);
        if (event == LINE_SPLITTER_KEY) {
            take_key(console, byte);
        } else if (event == LINE_SPLITTER_LINE) {
            take_checked_line(console);
            if (program_link_read_targets(&console->link, &board)) {
                return;
            }
        }
    }
}

// ---------------------------------------------------------------- what is told

static bool job_line(struct board_console *console, struct text *text) {
    const uint32_t line = console->job_line++;
    const char *help;
    switch (console->job) {
    case BOARD_CONSOLE_GREETING:
        return board_status_greet(console->status, console->notes, line, text);
    case BOARD_CONSOLE_HELP:
        help = request_help(line);
        if (help != NULL) {
            text_string(text, help);
        }
        return help != NULL;
    case BOARD_CONSOLE_STATUS:
        // Who it is comes first, and then how it is.
        return line == 0U ? board_status_greet(console->status, console->notes, 0, text)
                          : board_status_tell(console->status, console->pump, line - 1U, text);
    case BOARD_CONSOLE_SETTINGS:
        return board_settings_list(console->settings, line, text);
    default:
        return false;
    }
}

static void go_on_telling(struct board_console *console) {
    char buffer[BOARD_CONSOLE_LINE_BYTES - 2U];
    struct text text;
    text_begin(&text, buffer, sizeof buffer);
    if (job_line(console, &text)) {
        text_string(&text, "\r\n");
        put(console, &text);
        return;
    }
    console->job = BOARD_CONSOLE_QUIET;
    if (console->talks) {
        prompt(console);
    }
}

/// Telemetry goes above what somebody is typing.
static void trace(struct board_console *console) {
    char buffer[BOARD_CONSOLE_LINE_BYTES + LINE_EDITOR_ECHO_BYTES];
    struct text text;
    const uint64_t period_us = (uint64_t)console->trace_ms * 1000U;
    if (!console->traces || console->now_us - console->traced_us < period_us) {
        return;
    }
    console->traced_us += period_us;
    text_begin(&text, buffer, BOARD_CONSOLE_LINE_BYTES - 2U);
    if (console->talks) {
        text_string(&text, "\r\033[K");
    }
    board_status_trace(console->status, console->pump, (uint32_t)(console->traced_us / 1000000U),
                       &text);
    text.capacity_bytes = sizeof buffer;
    text_string(&text, "\r\n");
    if (console->talks) {
        line_editor_show(&console->editor, &text);
    }
    put(console, &text);
    board_status_begin_period(console->status);
}

static void tell(struct board_console *console) {
    char buffer[CHECKED_LINE_BYTES_MAX];
    struct text text;
    if (has_room(console) && program_link_status_due(&console->link, console->now_us)) {
        const struct program_link_board board = board_of(console);
        text_begin(&text, buffer, sizeof buffer);
        program_link_write_status(&console->link, &board, console->splitter.damaged, &text);
        put(console, &text);
    }
    if (console->job != BOARD_CONSOLE_QUIET && has_room(console)) {
        go_on_telling(console);
    }
    if (console->job == BOARD_CONSOLE_QUIET && has_room(console)) {
        trace(console);
    }
}

void board_console_poll(struct board_console *console) {
    const uint32_t now_us = console->pump->input.now_us;
    console->now_us += hal_clock_span_us(console->last_us, now_us);
    console->last_us = now_us;
    read_input(console);
    const struct program_link_board board = board_of(console);
    program_link_tick(&console->link, &board);
    tell(console);
    flush(console);
}

#include "app/program_link.h"

#include "link/compact.h"

void program_link_init(struct program_link *link) {
    *link = (struct program_link){.owned = false};
}

// ---------------------------------------------------------------- answers

static void begin(struct text *answer, const struct checked_line *line, char type) {
    checked_line_begin(answer, line->host, line->sequence, type);
}

/// An answer that does not fit is none.
static void end(struct text *answer) {
    if (!checked_line_end(answer)) {
        answer->size_bytes = 0;
    }
}

static void answer_command(const struct checked_line *line, const char *wrong,
                           const struct text *found, struct text *answer) {
    begin(answer, line, 'C');
    text_string(answer, wrong != NULL ? "no " : "ok");
    if (wrong != NULL) {
        text_string(answer, wrong);
    } else if (found->size_bytes != 0U) {
        text_character(answer, ' ');
        text_characters(answer, found->buffer, found->size_bytes);
    }
    end(answer);
}

static void hex64(struct text *text, uint64_t value) {
    text_hex_digits(text, (uint32_t)(value >> 32), 8);
    text_hex_digits(text, (uint32_t)value, 8);
}

// ---------------------------------------------------------------- owner

static bool is_owner(const struct program_link *link, uint8_t host) {
    return link->owned && link->host == host;
}

static void release(struct program_link *link, const struct program_link_board *board) {
    link->owned = link->holds = false;
    link->rest.size_bytes = 0;
    board_commands_stop_and_forget(board->commands);
}

/// `h`: which protocol, which rig, which build. Whoever says hello begins anew, also the owner:
/// stopped, without targets, with lines counted from here.
static void take_hello(struct program_link *link, const struct checked_line *line,
                       const struct program_link_board *board, struct text *answer) {
    begin(answer, line, 'H');
    if (link->owned && link->host != line->host) {
        link->counts.refused++;
        text_string(answer, "busy");
        end(answer);
        return;
    }
    link->owned = true;
    link->host = line->host;
    link->heard_us = link->status_us = board->now_us;
    link->has_command = link->has_targets = link->holds = false;
    board_commands_stop_and_forget(board->commands);
    text_unsigned(answer, PROGRAM_LINK_VERSION, 0);
    text_character(answer, ' ');
    text_hex_digits(answer, board->digest, 8);
    text_character(answer, ' ');
    text_string(answer, build_id);
    end(answer);
}

// ---------------------------------------------------------------- commands

/// The frame is whole.
static void end_frame(struct program_link *link, const struct program_link_board *board) {
    link->holds = false;
    pump_release(board->commands->pump);
}

static bool is_for_programs(enum request_kind kind) {
    return kind != REQUEST_HELP && kind != REQUEST_STATUS && kind != REQUEST_TRACE;
}

/// A command that comes again, because its answer was lost, is only answered again.
static void take_command(struct program_link *link, const struct checked_line *line,
                         const struct program_link_board *board, struct text *answer) {
    char buffer[64];
    struct text found;
    struct request request = {.kind = REQUEST_HELP};
    text_begin(&found, buffer, sizeof buffer);
    const char *wrong = request_read(line->body.text, line->body.size_bytes, &request);
    const bool is_stop = wrong == NULL && request.kind == REQUEST_STOP;
    if (!is_owner(link, line->host) && !is_stop) {
        link->counts.refused++;
        answer_command(line, "say hello first", &found, answer);
        return;
    }
    const bool again =
        is_owner(link, line->host) && link->has_command && link->command_sequence == line->sequence;
    if (again && request.kind != REQUEST_GET) {
        link->counts.repeated++;
        answer_command(line, link->command_wrong, &found, answer);
        return;
    }
    if (wrong == NULL) {
        end_frame(link, board); // what came before the command stays before it
        wrong = is_for_programs(request.kind)
                    ? board_commands_do(board->commands, &request, board->held, &found)
                    : "this is for people";
    }
    link->counts.taken += wrong == NULL;
    link->counts.refused += wrong != NULL;
    if (is_owner(link, line->host)) {
        link->has_command = true;
        link->command_sequence = line->sequence;
        link->command_wrong = wrong;
    }
    answer_command(line, wrong, &found, answer);
}

// ---------------------------------------------------------------- targets

static void skip(struct word *rest, uint32_t count) {
    rest->text += count;
    rest->size_bytes -= count;
}

/// How old a line is by its stamp, the low bits of the board's time in units of 1024 us. "----":
/// the program does not know the board's time.
static bool is_fresh(const char *stamp, uint64_t now_us) {
    uint32_t then;
    if (word_is((struct word){stamp, PROGRAM_LINK_STAMP_HEX}, "----")) {
        return true;
    }
    if (!word_hex((struct word){stamp, PROGRAM_LINK_STAMP_HEX}, PROGRAM_LINK_STAMP_HEX, &then)) {
        return false;
    }
    const uint32_t age = ((uint32_t)(now_us >> 10) - then) & 0xFFFFU;
    return age <= PROGRAM_LINK_AGE_MAX || age >= 0x10000U - PROGRAM_LINK_AHEAD_MAX;
}

/// What is read from here on belongs together.
static void begin_line_of_frame(struct program_link *link, const struct program_link_board *board) {
    if (!link->holds) {
        link->holds = true;
        link->held_us = board->now_us;
        pump_hold(board->commands->pump);
    }
}

/// `t` STAMP MORE TARGET;TARGET... or `d` STAMP MORE FIRST CODES. Lines that come again, or that a
/// later one has overtaken, are no news.
static void take_targets(struct program_link *link, const struct checked_line *line,
                         const struct program_link_board *board) {
    struct word rest = line->body;
    const bool is_compact = line->type == 'd';
    const uint8_t newer = (uint8_t)(line->sequence - link->targets_sequence);
    if (link->has_targets && (newer == 0U || newer >= 128U)) {
        link->counts.repeated++;
        return;
    }
    const bool is_long = rest.size_bytes >= PROGRAM_LINK_STAMP_HEX + (is_compact ? 3U : 1U);
    const char more = is_long ? rest.text[PROGRAM_LINK_STAMP_HEX] : '\0';
    if (more != PROGRAM_LINK_MORE && more != PROGRAM_LINK_LAST) {
        link->counts.refused++;
        return;
    }
    if (!is_fresh(rest.text, board->now_us)) {
        link->counts.stale++;
        return;
    }
    skip(&rest, PROGRAM_LINK_STAMP_HEX + 1U);
    if (is_compact) {
        if (!word_hex((struct word){rest.text, 2}, 2, &link->next_number)) {
            link->counts.refused++;
            return;
        }
        skip(&rest, 2);
    }
    link->has_targets = true;
    link->targets_sequence = line->sequence;
    link->is_compact = is_compact;
    link->rest = rest;
    link->more = more == PROGRAM_LINK_MORE;
    link->counts.taken++;
    begin_line_of_frame(link, board);
}

/// Six characters, or `~` for a number that this line says nothing about.
static bool read_compact(struct program_link *link, struct target_update *update, bool *is_news) {
    struct word *rest = &link->rest;
    const uint32_t number = link->next_number++;
    bam32_t pan, tilt;
    *is_news = rest->text[0] != '~';
    if (!*is_news) {
        skip(rest, 1);
        return true;
    }
    if (rest->size_bytes < COMPACT_CHARACTERS || !compact_read(rest->text, &pan, &tilt)) {
        return false;
    }
    skip(rest, COMPACT_CHARACTERS);
    *update = request_aim(pan, tilt, 0);
    update->id = number;
    return true;
}

static bool read_text(struct program_link *link, struct target_update *update, bool *is_news) {
    struct word *rest = &link->rest;
    uint32_t size = 0;
    while (size < rest->size_bytes && rest->text[size] != ';') {
        size++;
    }
    *is_news = true;
    const bool good = request_read_target(rest->text, size, update) == NULL;
    skip(rest, size + (size < rest->size_bytes));
    return good;
}

bool program_link_read_targets(struct program_link *link, const struct program_link_board *board) {
    for (uint32_t i = 0; i < PROGRAM_LINK_TARGETS_MAX && link->rest.size_bytes != 0U; i++) {
        struct target_update update;
        bool is_news;
        const bool good = link->is_compact ? read_compact(link, &update, &is_news)
                                           : read_text(link, &update, &is_news);
        if (!good) {
            link->counts.refused++;
            link->rest.size_bytes = 0; // what follows may be anything
        } else if (is_news) {
            (void)!board_commands_update(board->commands, &update); // the pump counts it
        }
    }
    if (link->rest.size_bytes == 0U && link->holds && !link->more) {
        end_frame(link, board);
    }
    return link->rest.size_bytes != 0U;
}

// ---------------------------------------------------------------- lines

void program_link_take(struct program_link *link, const struct checked_line *line,
                       const struct program_link_board *board, struct text *answer) {
    const bool owner = is_owner(link, line->host);
    link->heard_us = owner ? board->now_us : link->heard_us;
    switch (line->type) {
    case 'h':
        take_hello(link, line, board, answer);
        return;
    case 'c':
        take_command(link, line, board, answer);
        return;
    case 'p':
        begin(answer, line, 'P');
        hex64(answer, board->now_us);
        end(answer);
        return;
    case 't':
    case 'd':
        if (owner) {
            take_targets(link, line, board);
            return;
        }
        break;
    case 'b':
        if (owner) {
            release(link, board);
            begin(answer, line, 'B');
            end(answer);
            return;
        }
        break;
    default:
        break;
    }
    link->counts.refused++;
}

void program_link_tick(struct program_link *link, const struct program_link_board *board) {
    if (link->owned && board->now_us - link->heard_us > PROGRAM_LINK_SILENCE_US) {
        release(link, board);
    }
    if (link->holds && board->now_us - link->held_us > PROGRAM_LINK_FRAME_US) {
        end_frame(link, board);
    }
}

// ---------------------------------------------------------------- status

bool program_link_status_due(const struct program_link *link, uint64_t now_us) {
    return link->owned && now_us - link->status_us >= PROGRAM_LINK_STATUS_US;
}

/// Thousandths of a degree, rounded down. position_q48: within 2,000 turns.
static void put_angle(struct text *text, int64_t position_q48) {
    const int64_t turns_q32 =
        position_q48 / (INT64_C(1) << 16) - (position_q48 % (INT64_C(1) << 16) < 0);
    const int64_t scaled = turns_q32 * 360000;
    text_character(text, ' ');
    text_decimal(text, scaled / (INT64_C(1) << 32) - (scaled % (INT64_C(1) << 32) < 0), 3);
}

static void put_axis(struct text *text, const struct controller_axis_status *axis) {
    put_angle(text, axis->setpoint_q48);
    put_angle(text, axis->goal_q48);
    if (axis->measured_known) {
        put_angle(text, axis->measured_q48);
    } else {
        text_string(text, " -");
    }
}

static void put_number(struct text *text, uint32_t number) {
    text_character(text, ' ');
    text_unsigned(text, number, 0);
}

void program_link_write_status(struct program_link *link, const struct program_link_board *board,
                               uint32_t damaged, struct text *text) {
    const struct controller_status *status = &board->commands->pump->output.status;
    link->status_us += PROGRAM_LINK_STATUS_US;
    if (board->now_us - link->status_us >= PROGRAM_LINK_STATUS_US) {
        link->status_us = board->now_us; // the line was full: what is late is left out
    }
    checked_line_begin(text, link->host, link->status_sequence++, 'S');
    hex64(text, board->now_us);
    text_character(text, ' ');
    text_string(text, controller_mode_name(status->mode));
    put_number(text, status->faults);
    put_axis(text, &status->axis[AXIS_PAN]);
    put_axis(text, &status->axis[AXIS_TILT]);
    put_number(text, status->focal_um);
    put_number(text, status->target_count);
    put_number(text, status->updates_rejected);
    put_number(text, link->counts.taken);
    put_number(text, damaged);
    put_number(text, link->counts.stale);
    put_number(text, link->counts.repeated);
    put_number(text, link->counts.refused);
    if (board->held != NULL) {
        text_character(text, ' ');
        text_string(text, board->held);
    }
    end(text);
}

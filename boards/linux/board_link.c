#include "board_link.h"

#include <stdlib.h>
#include <string.h>

void board_link_init(struct board_link *link, const struct hal_serial *serial, uint32_t baud,
                     uint8_t host, uint64_t now_us) {
    memset(link, 0, sizeof *link);
    link->serial = serial;
    link->host = host;
    link->heard_us = link->told_us = link->paced_us = now_us;
    link->bytes_a_second = baud / 10U;
    line_splitter_init(&link->splitter);
    board_clock_init(&link->clock);
}

// ---------------------------------------------------------------- out

static bool put(struct board_link *link, const struct text *line) {
    if (sizeof link->out - link->out_count < line->size_bytes) {
        return false;
    }
    memcpy(link->out + link->out_count, line->buffer, line->size_bytes);
    link->out_count += line->size_bytes;
    link->lines_sent++;
    return true;
}

static bool send(struct board_link *link, uint8_t sequence, char type, const char *body,
                 uint32_t size) {
    char buffer[CHECKED_LINE_BYTES_MAX];
    struct text line;
    text_begin(&line, buffer, sizeof buffer);
    checked_line_begin(&line, link->host, sequence, type);
    text_characters(&line, body, size);
    return checked_line_end(&line) && put(link, &line);
}

/// As much as the line has carried since the last time, and at most 3 ms worth at once.
static void write_paced(struct board_link *link, uint64_t now_us) {
    const uint64_t elapsed_us = now_us - link->paced_us;
    const uint64_t most_ub = (uint64_t)link->bytes_a_second * 3000U + 1000000U;
    link->paced_us = now_us;
    link->allowed_ub += (elapsed_us < 100000U ? elapsed_us : 100000U) * link->bytes_a_second;
    link->allowed_ub = link->allowed_ub < most_ub ? link->allowed_ub : most_ub;
    const uint32_t allowed = (uint32_t)(link->allowed_ub / 1000000U);
    const uint32_t size = link->out_count < allowed ? link->out_count : allowed;
    size_t written = 0;
    if (size == 0U) {
        return;
    }
    const enum hal_status status = hal_serial_write(link->serial, link->out, size, &written);
    link->gone = link->gone || status == HAL_ERROR_GONE;
    link->allowed_ub -= (uint64_t)written * 1000000U;
    link->out_count -= (uint32_t)written;
    memmove(link->out, link->out + written, link->out_count);
}

enum board_link_presence board_link_presence(const struct board_link *link, uint64_t now_us) {
    if (now_us - link->heard_us > BOARD_LINK_SILENCE_US) {
        return BOARD_LINK_SILENT;
    }
    // A board that falls silent may have answered a question after its last status. So it has let
    // go of us only if it went on answering.
    const bool answers = link->heard_us > link->told_us &&
                         link->heard_us - link->told_us > BOARD_LINK_SILENCE_US / 2U;
    return answers && now_us - link->told_us > BOARD_LINK_SILENCE_US ? BOARD_LINK_LET_GO
                                                                     : BOARD_LINK_THERE;
}

uint32_t board_link_waiting(const struct board_link *link) {
    return link->out_count;
}

// ---------------------------------------------------------------- in

/// Body as a string.
static void copy(char *to, size_t capacity, const char *from, size_t size) {
    const size_t fits = size < capacity - 1U ? size : capacity - 1U;
    memcpy(to, from, fits);
    to[fits] = '\0';
}

static void take_identity(struct board_link *link, struct word body) {
    struct words words = words_of(body.text, body.size_bytes);
    struct word version, digest;
    struct board_link_identity *identity = &link->identity;
    identity->busy = word_is(body, "busy");
    if (!identity->busy && words_next(&words, &version) &&
        word_unsigned(version, UINT32_MAX, &identity->version)) {
        // Another version may say what it likes behind its number.
        identity->known = true;
        identity->digest = 0;
        if (words_next(&words, &digest) && word_hex(digest, 8, &identity->digest)) {
            copy(identity->build, sizeof identity->build, words.at + (words.at != words.end),
                 (size_t)(words.end - words.at - (words.at != words.end)));
        }
    }
    link->says_hello = link->says_hello && !identity->known && !identity->busy;
}

static bool read_u64(struct word word, uint64_t *value) {
    uint32_t high, low;
    if (word.size_bytes != 16U || !word_hex((struct word){word.text, 8}, 8, &high) ||
        !word_hex((struct word){word.text + 8, 8}, 8, &low)) {
        return false;
    }
    *value = (uint64_t)high << 32 | low;
    return true;
}

static void take_time(struct board_link *link, const struct checked_line *line, uint64_t now_us) {
    uint64_t board_us;
    if (link->ping_waits && line->sequence == link->ping_sequence &&
        read_u64(line->body, &board_us)) {
        link->ping_waits = false;
        board_clock_take(&link->clock, link->ping_us, now_us, board_us);
    }
}

static void take_answer(struct board_link *link, const struct checked_line *line) {
    struct words words = words_of(line->body.text, line->body.size_bytes);
    struct word verdict;
    if (link->command != BOARD_LINK_WAITS || line->sequence != link->command_sequence ||
        !words_next(&words, &verdict)) {
        return;
    }
    link->command = BOARD_LINK_ANSWERED;
    link->refused = !word_is(verdict, "ok");
    const bool more = words.at != words.end;
    copy(link->answer, sizeof link->answer, words.at + more, (size_t)(words.end - words.at - more));
}

// ---------------------------------------------------------------- status

static bool read_number(struct words *words, uint32_t *number) {
    struct word word;
    return words_next(words, &word) && word_unsigned(word, UINT32_MAX, number);
}

static bool read_angle(struct words *words, int32_t *angle_mdeg, bool *known) {
    struct word word;
    int64_t value = 0;
    *known = words_next(words, &word) && !word_is(word, "-");
    *angle_mdeg = 0;
    if (*known && !word_decimal(word, 3, INT32_MAX, &value)) {
        return false;
    }
    *angle_mdeg = (int32_t)value;
    return word.size_bytes != 0U;
}

static bool read_axis(struct words *words, unsigned axis, struct board_link_status *status) {
    bool known[2];
    return read_angle(words, &status->setpoint_mdeg[axis], &known[0]) && known[0] &&
           read_angle(words, &status->goal_mdeg[axis], &known[1]) && known[1] &&
           read_angle(words, &status->measured_mdeg[axis], &status->measured[axis]);
}

static bool read_mode(struct words *words, enum controller_mode *mode) {
    struct word word;
    if (!words_next(words, &word)) {
        return false;
    }
    for (enum controller_mode m = MODE_STARTING; m <= MODE_FAULTED; m++) {
        if (word_is(word, controller_mode_name(m))) {
            *mode = m;
            return true;
        }
    }
    return false;
}

static void take_status(struct board_link *link, struct word body, uint64_t now_us) {
    struct board_link_status status = {0};
    struct words words = words_of(body.text, body.size_bytes);
    struct word time;
    const bool good = words_next(&words, &time) && read_u64(time, &status.board_us) &&
                      read_mode(&words, &status.mode) && read_number(&words, &status.faults) &&
                      read_axis(&words, 0, &status) && read_axis(&words, 1, &status) &&
                      read_number(&words, &status.focal_um) &&
                      read_number(&words, &status.targets) &&
                      read_number(&words, &status.rejected) && read_number(&words, &status.taken) &&
                      read_number(&words, &status.damaged) && read_number(&words, &status.stale) &&
                      read_number(&words, &status.repeated) && read_number(&words, &status.refused);
    if (!good) {
        return;
    }
    const bool more = words.at != words.end;
    copy(status.held, sizeof status.held, words.at + more, (size_t)(words.end - words.at - more));
    link->status = status;
    link->status_count++;
    const uint64_t gap_us = now_us - link->told_us;
    link->gap_us_max =
        link->status_count > 1U && gap_us > link->gap_us_max ? gap_us : link->gap_us_max;
    link->told_us = now_us;
}

static void take_line(struct board_link *link, uint64_t now_us) {
    const struct checked_line *line = &link->splitter.line;
    if (line->host != link->host) {
        return;
    }
    link->heard_us = now_us;
    switch (line->type) {
    case 'H':
        take_identity(link, line->body);
        break;
    case 'P':
        take_time(link, line, now_us);
        break;
    case 'C':
        take_answer(link, line);
        break;
    case 'S':
        take_status(link, line->body, now_us);
        break;
    default:
        break;
    }
}

static void read_lines(struct board_link *link, uint64_t now_us) {
    for (;;) {
        uint8_t bytes[512];
        size_t count = 0;
        const enum hal_status status = hal_serial_read(link->serial, bytes, sizeof bytes, &count);
        link->gone = link->gone || status == HAL_ERROR_GONE;
        if (status != HAL_OK) {
            return;
        }
        link->bytes_received += count;
        for (size_t i = 0; i < count; i++) {
            if (line_splitter_take(&link->splitter, bytes[i]) == LINE_SPLITTER_LINE) {
                take_line(link, now_us);
            }
        }
    }
}

// ---------------------------------------------------------------- what is sent by itself

static void say_hello(struct board_link *link, uint64_t now_us) {
    if (link->says_hello && now_us - link->hello_us >= BOARD_LINK_RETRY_US) {
        link->hello_us = now_us;
        (void)send(link, ++link->question_sequence, 'h', "", 0);
    }
}

/// Only when nothing waits before it: it is to leave at the time that is noted.
static void ask_for_time(struct board_link *link, uint64_t now_us) {
    const uint64_t wait_us =
        link->clock.answers < 10U ? BOARD_LINK_PING_US / 5U : BOARD_LINK_PING_US;
    if (!link->identity.known || now_us - link->ping_us < wait_us) {
        return;
    }
    const bool urgent = now_us - link->ping_us > 3U * wait_us;
    if (link->out_count == 0U || urgent) { // a longer way only makes the bounds worse
        link->ping_sequence = ++link->question_sequence;
        link->ping_waits = send(link, link->ping_sequence, 'p', "", 0);
        link->ping_us = now_us;
    }
}

static void repeat_command(struct board_link *link, uint64_t now_us) {
    if (link->command != BOARD_LINK_WAITS || now_us - link->command_us < BOARD_LINK_RETRY_US) {
        return;
    }
    if (link->command_tries == BOARD_LINK_TRIES_MAX) {
        link->command = BOARD_LINK_LOST;
        return;
    }
    link->command_us = now_us;
    link->command_tries++;
    (void)send(link, link->command_sequence, 'c', link->command_text,
               (uint32_t)strlen(link->command_text));
}

void board_link_poll(struct board_link *link, uint64_t now_us) {
    read_lines(link, now_us);
    say_hello(link, now_us);
    repeat_command(link, now_us);
    ask_for_time(link, now_us);
    write_paced(link, now_us);
}

// ---------------------------------------------------------------- orders

void board_link_hello(struct board_link *link) {
    link->identity = (struct board_link_identity){.known = false};
    link->says_hello = true;
}

void board_link_order(struct board_link *link, const char *text, uint64_t now_us) {
    if (strcmp(text, "stop") == 0) {
        link->out_count = 0; // the board finds one damaged line at most, and then the stop
        link->ping_waits = false;
    }
    copy(link->command_text, sizeof link->command_text, text, strlen(text));
    link->command = BOARD_LINK_WAITS;
    link->command_sequence++;
    link->command_tries = 0;
    link->command_us = now_us - BOARD_LINK_RETRY_US;
    repeat_command(link, now_us);
}

bool board_link_send_targets(struct board_link *link, char type, const struct text *body) {
    if (!send(link, (uint8_t)(link->targets_sequence + 1U), type, body->buffer, body->size_bytes)) {
        return false;
    }
    link->targets_sequence++;
    link->target_lines_sent++;
    return true;
}

void board_link_stamp(const struct board_link *link, uint64_t now_us, struct text *text) {
    uint64_t board_us, error_us;
    if (board_clock_read(&link->clock, now_us, &board_us, &error_us)) {
        text_hex_digits(text, (uint32_t)(board_us >> 10) & 0xFFFFU, 4);
    } else {
        text_string(text, "----");
    }
}

void board_link_bye(struct board_link *link) {
    (void)send(link, ++link->question_sequence, 'b', "", 0);
}

/// A program at the other end of the serial line of desk.h.
#ifndef TESTS_UNIT_PROGRAM_H
#define TESTS_UNIT_PROGRAM_H

#include "desk.h"

enum { ME = 0x3f, OTHER = 0x77 };

static struct program { uint8_t host, sequence; } me = {ME, 0}, other = {OTHER, 0};

static char buffer[CHECKED_LINE_BYTES_MAX];
static struct text text;

/// The last checked line of a type that the board said, and how many there were.
static struct {
    char body[CHECKED_LINE_BYTES_MAX];
    uint32_t size, count;
    uint8_t host, sequence;
} got;

static inline void begin(struct program *program, char type) {
    text_begin(&text, buffer, sizeof buffer);
    checked_line_begin(&text, program->host, ++program->sequence, type);
}

static inline void end(void) {
    CHECK(checked_line_end(&text));
    desk_send(buffer, text.size_bytes);
}

static inline void send(struct program *program, char type, const char *body) {
    begin(program, type);
    text_string(&text, body);
    end();
}

/// Looks through all that was said for lines of that type.
static inline bool hear(char type) {
    static struct line_splitter splitter;
    line_splitter_init(&splitter);
    got.count = 0;
    for (uint32_t i = 0; i < desk.said_count; i++) {
        if (line_splitter_take(&splitter, (uint8_t)desk.said[i]) == LINE_SPLITTER_LINE &&
            splitter.line.type == type) {
            got.count++;
            got.host = splitter.line.host;
            got.sequence = splitter.line.sequence;
            got.size = splitter.line.body.size_bytes;
            for (uint32_t c = 0; c < got.size; c++) {
                got.body[c] = splitter.line.body.text[c];
            }
        }
    }
    desk_forget();
    return got.count != 0U;
}

static inline bool body_begins(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < got.size && got.body[i] == wanted[i]) {
        i++;
    }
    return wanted[i] == '\0';
}

static inline bool body_is(const char *wanted) {
    uint32_t size = 0;
    while (wanted[size] != '\0') {
        size++;
    }
    return got.size == size && body_begins(wanted);
}

/// A word of the last status, from 0.
static inline struct word status_word(uint32_t index) {
    struct words words = words_of(got.body, got.size);
    struct word word = {got.body, 0};
    for (uint32_t i = 0; i <= index; i++) {
        (void)!words_next(&words, &word);
    }
    return word;
}

static inline bool command(struct program *program, const char *words, const char *wanted) {
    desk_forget();
    send(program, 'c', words);
    desk_ticks(30);
    return hear('C') && got.host == program->host && got.sequence == program->sequence &&
           body_is(wanted);
}

static inline void switch_on(void) {
    desk_configure();
    desk_start(115200);
    me.sequence = other.sequence = 0;
    desk_ticks(50);
    desk_forget();
    send(&me, 'h', "1");
    desk_ticks(20);
    CHECK(hear('H'));
    desk_ticks(1);
}

static inline const struct program_link_counts *counted(void) {
    return &desk_loop.console.link.counts;
}

static inline void put_stamp(int64_t age_units) {
    const uint64_t now = desk_loop.console.now_us >> 10;
    text_hex_digits(&text, (uint32_t)(now - (uint64_t)age_units) & 0xFFFFU, 4);
}

#endif

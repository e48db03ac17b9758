#include "link/line_splitter.h"

void line_splitter_init(struct line_splitter *splitter) {
    splitter->state = LINE_SPLITTER_OUTSIDE;
    splitter->size_bytes = 0;
    splitter->damaged = 0;
    splitter->line = (struct checked_line){0};
}

static enum line_splitter_event damaged(struct line_splitter *splitter,
                                        enum line_splitter_state state) {
    splitter->state = state;
    splitter->damaged++;
    return LINE_SPLITTER_DAMAGED;
}

static enum line_splitter_event begin(struct line_splitter *splitter) {
    const bool unfinished = splitter->state == LINE_SPLITTER_INSIDE;
    splitter->size_bytes = 0;
    splitter->state = LINE_SPLITTER_INSIDE;
    return unfinished ? damaged(splitter, LINE_SPLITTER_INSIDE) : LINE_SPLITTER_NOTHING;
}

static enum line_splitter_event end(struct line_splitter *splitter, bool is_cr) {
    const enum line_splitter_state next = is_cr ? LINE_SPLITTER_AFTER_CR : LINE_SPLITTER_OUTSIDE;
    if (!checked_line_read(splitter->text, splitter->size_bytes, &splitter->line)) {
        return damaged(splitter, next);
    }
    splitter->state = next;
    return LINE_SPLITTER_LINE;
}

static enum line_splitter_event take_inside(struct line_splitter *splitter, uint8_t byte) {
    if (byte == '\r' || byte == '\n') {
        return end(splitter, byte == '\r');
    }
    if (byte < ' ' || byte > '~' || splitter->size_bytes == sizeof splitter->text) {
        return damaged(splitter, LINE_SPLITTER_DROPPING);
    }
    splitter->text[splitter->size_bytes++] = (char)byte;
    return LINE_SPLITTER_NOTHING;
}

enum line_splitter_event line_splitter_take(struct line_splitter *splitter, uint8_t byte) {
    const bool after_cr = splitter->state == LINE_SPLITTER_AFTER_CR;
    splitter->state = after_cr ? LINE_SPLITTER_OUTSIDE : splitter->state;
    if (byte == '$') {
        return begin(splitter);
    }
    if (byte == LINE_SPLITTER_STOP_KEY) {
        splitter->damaged += splitter->state == LINE_SPLITTER_INSIDE;
        splitter->state = LINE_SPLITTER_OUTSIDE;
        return LINE_SPLITTER_KEY;
    }
    if (splitter->state == LINE_SPLITTER_INSIDE) {
        return take_inside(splitter, byte);
    }
    if (splitter->state == LINE_SPLITTER_DROPPING) {
        if (byte == '\r' || byte == '\n') {
            splitter->state = byte == '\r' ? LINE_SPLITTER_AFTER_CR : LINE_SPLITTER_OUTSIDE;
        }
        return LINE_SPLITTER_NOTHING;
    }
    return after_cr && byte == '\n' ? LINE_SPLITTER_NOTHING : LINE_SPLITTER_KEY;
}

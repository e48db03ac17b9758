#include "link/line_editor.h"

enum {
    CTRL_A = 1,
    CTRL_B,
    CTRL_C,
    CTRL_D,
    CTRL_E,
    CTRL_F,
    BELL,
    CTRL_H,
    CTRL_K = 11,
    CTRL_L,
    CTRL_N = 14,
    CTRL_P = 16,
    CTRL_U = 21,
    CTRL_W = 23,
    ESCAPE = 27,
    BACKSPACE = 127
};

void line_editor_init(struct line_editor *editor) {
    *editor = (struct line_editor){0};
}

void line_editor_show(const struct line_editor *editor, struct text *echo) {
    text_string(echo, "\r> ");
    text_characters(echo, editor->line.text, editor->line.size_bytes);
    text_string(echo, "\033[K");
    const uint32_t back = editor->line.size_bytes - editor->cursor;
    if (back != 0U) {
        text_string(echo, "\033[");
        text_unsigned(echo, back, 0);
        text_character(echo, 'D');
    }
}

// ---------------------------------------------------------------- the line

/// Removes what stands before `to` from `from` on.
static void erase(struct line_editor *editor, uint32_t from, uint32_t to) {
    struct line_editor_text *line = &editor->line;
    for (uint32_t i = to; i < line->size_bytes; i++) {
        line->text[i - (to - from)] = line->text[i];
    }
    line->size_bytes -= to - from;
    editor->cursor = from;
}

static void insert(struct line_editor *editor, char character, struct text *echo) {
    struct line_editor_text *line = &editor->line;
    if (line->size_bytes == LINE_EDITOR_BYTES) {
        text_character(echo, (char)BELL);
        return;
    }
    for (uint32_t i = line->size_bytes; i > editor->cursor; i--) {
        line->text[i] = line->text[i - 1U];
    }
    line->text[editor->cursor++] = character;
    line->size_bytes++;
    if (editor->cursor == line->size_bytes) {
        text_character(echo, character);
    } else {
        line_editor_show(editor, echo);
    }
}

static uint32_t word_start(const struct line_editor *editor) {
    uint32_t at = editor->cursor;
    while (at != 0U && editor->line.text[at - 1U] == ' ') {
        at--;
    }
    while (at != 0U && editor->line.text[at - 1U] != ' ') {
        at--;
    }
    return at;
}

// ---------------------------------------------------------------- the last lines

static void remember(struct line_editor *editor) {
    if (editor->line.size_bytes == 0U) {
        return;
    }
    for (uint32_t i = LINE_EDITOR_HISTORY - 1U; i != 0U; i--) {
        editor->history[i] = editor->history[i - 1U];
    }
    editor->history[0] = editor->line;
    editor->history_count += editor->history_count < LINE_EDITOR_HISTORY;
}

/// at: 0 is a new line.
static void recall(struct line_editor *editor, uint32_t at) {
    if (at <= editor->history_count) {
        editor->history_at = at;
        editor->line =
            at != 0U ? editor->history[at - 1U] : (struct line_editor_text){.size_bytes = 0};
        editor->cursor = editor->line.size_bytes;
    }
}

// ---------------------------------------------------------------- keys

/// Keys that change the line or the cursor. All of them show the line anew.
static void edit(struct line_editor *editor, uint8_t key) {
    const uint32_t size = editor->line.size_bytes, at = editor->cursor;
    switch (key) {
    case CTRL_A:
        editor->cursor = 0;
        break;
    case CTRL_E:
        editor->cursor = size;
        break;
    case CTRL_B:
        editor->cursor = at - (at != 0U);
        break;
    case CTRL_F:
        editor->cursor = at + (at != size);
        break;
    case CTRL_H:
    case BACKSPACE:
        erase(editor, at - (at != 0U), at);
        break;
    case CTRL_D:
        erase(editor, at, at + (at != size));
        break;
    case CTRL_K:
        erase(editor, at, size);
        break;
    case CTRL_U:
        erase(editor, 0, at);
        break;
    case CTRL_W:
        erase(editor, word_start(editor), at);
        break;
    case CTRL_P:
        recall(editor, editor->history_at + 1U);
        break;
    case CTRL_N:
        recall(editor, editor->history_at - (editor->history_at != 0U));
        break;
    default:
        break;
    }
}

/// The control key that does the same as the last character of a cursor key's sequence; 0: none.
static uint8_t meaning(uint8_t last, uint32_t parameter) {
    static const uint8_t numbered[] = {0, CTRL_A, 0, CTRL_D, CTRL_E, 0, 0, CTRL_A, CTRL_E};
    switch (last) {
    case 'A':
        return CTRL_P;
    case 'B':
        return CTRL_N;
    case 'C':
        return CTRL_F;
    case 'D':
        return CTRL_B;
    case 'H':
        return CTRL_A;
    case 'F':
        return CTRL_E;
    case '~':
        return parameter < sizeof numbered ? numbered[parameter] : 0U;
    default:
        return 0;
    }
}

/// ESC, then `[` or `O`, then digits and `;`, then a last character from `@` to `~`.
static void take_escape(struct line_editor *editor, uint8_t key, struct text *echo) {
    if (editor->escape == LINE_EDITOR_ESCAPE) {
        editor->escape = key == '[' || key == 'O' ? LINE_EDITOR_SEQUENCE : LINE_EDITOR_PLAIN;
        editor->parameter = 0;
    } else if (key >= '0' && key <= '9') {
        editor->parameter =
            editor->parameter < 100U ? editor->parameter * 10U + (uint32_t)(key - '0') : 999U;
    } else if (key != ';') {
        editor->escape = LINE_EDITOR_PLAIN;
        const uint8_t control = meaning(key, editor->parameter);
        if (control != 0U) {
            edit(editor, control);
            line_editor_show(editor, echo);
        }
    }
}

void line_editor_clear(struct line_editor *editor) {
    editor->line.size_bytes = editor->cursor = editor->history_at = 0;
}

static enum line_editor_event end_line(struct line_editor *editor, struct text *echo) {
    text_string(echo, "\r\n");
    remember(editor);
    return LINE_EDITOR_LINE;
}

enum line_editor_event line_editor_take(struct line_editor *editor, uint8_t key,
                                        struct text *echo) {
    const bool after_cr = editor->after_cr;
    editor->after_cr = key == '\r';
    if (key == CTRL_C) {
        editor->escape = LINE_EDITOR_PLAIN;
        line_editor_clear(editor);
        text_string(echo, "^C\r\n");
        return LINE_EDITOR_STOP;
    }
    if (key == '\r' || (key == '\n' && !after_cr)) {
        editor->escape = LINE_EDITOR_PLAIN;
        return end_line(editor, echo);
    }
    if (editor->escape != LINE_EDITOR_PLAIN) {
        take_escape(editor, key, echo);
    } else if (key == ESCAPE) {
        editor->escape = LINE_EDITOR_ESCAPE;
    } else if (key >= ' ' && key < BACKSPACE) {
        insert(editor, (char)key, echo);
    } else if (key < BACKSPACE + 1U && key != '\n') {
        edit(editor, key);
        line_editor_show(editor, echo);
    }
    return LINE_EDITOR_NOTHING;
}

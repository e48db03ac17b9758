/// link/line_editor: what a terminal gets for what is typed, byte by byte, and any bytes at all.
#include "check.h"

#include "link/line_editor.h"

static struct line_editor editor;
static char shown[4096];
static struct text echo;
static uint32_t lines, stops;

static void type(const char *keys) {
    for (uint32_t i = 0; keys[i] != '\0'; i++) {
        const uint32_t before = echo.size_bytes;
        const enum line_editor_event event = line_editor_take(&editor, (uint8_t)keys[i], &echo);
        CHECK(echo.size_bytes - before <= LINE_EDITOR_ECHO_BYTES);
        lines += event == LINE_EDITOR_LINE;
        stops += event == LINE_EDITOR_STOP;
        if (event == LINE_EDITOR_LINE && keys[i + 1U] != '\0') {
            line_editor_clear(&editor);
        }
    }
}

static void begin(void) {
    line_editor_init(&editor);
    text_begin(&echo, shown, sizeof shown);
    lines = stops = 0;
}

static bool line_is(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < editor.line.size_bytes && editor.line.text[i] == wanted[i]) {
        i++;
    }
    return wanted[i] == '\0' && i == editor.line.size_bytes;
}

static bool showed(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < echo.size_bytes && shown[i] == wanted[i]) {
        i++;
    }
    const bool same = wanted[i] == '\0' && i == echo.size_bytes;
    echo.size_bytes = 0;
    return same;
}

static void plain_typing(void) {
    begin();
    type("arm\r");
    CHECK(line_is("arm") && lines == 1U && showed("arm\r\n"));
    line_editor_clear(&editor);
    type("\n"); // of CR LF
    CHECK(lines == 1U && showed(""));
    type("\n");
    CHECK(lines == 2U && line_is("") && showed("\r\n"));
}

static void corrections(void) {
    begin();
    type("abd\b");
    CHECK(line_is("ab") && showed("abd\r> ab\033[K"));
    type("\177\177\177");
    CHECK(line_is("") && showed("\r> a\033[K\r> \033[K\r> \033[K"));
    type("ac\033[Db");
    CHECK(line_is("abc") && showed("ac\r> ac\033[K\033[1D\r> abc\033[K\033[1D"));
    type("\001x\005y");
    CHECK(line_is("xabcy"));
    type("\002\002\004\013");
    CHECK(line_is("xab"));
    type("\001\033[3~\006\013");
    CHECK(line_is("a"));
    type(" bc  de  \027");
    CHECK(line_is("a bc  "));
    type("\027\033[D\025");
    CHECK(line_is(" "));
    type("\033[H1\033[F2\033OH3\033OF4\033[1~5\033[4~6");
    CHECK(line_is("531 246"));
    echo.size_bytes = 0;
    type("\014");
    CHECK(showed("\r> 531 246\033[K"));
}

static void the_last_lines(void) {
    begin();
    type("one\rtwo\r\rthree\rfour\rfive\r");
    line_editor_clear(&editor);
    type("\033[A");
    CHECK(line_is("five"));
    type("\020\020\020\020\020");
    CHECK(line_is("two")); // four are kept, and the empty one is none of them
    type("\016");
    CHECK(line_is("three"));
    type("!\r");
    CHECK(line_is("three!"));
    line_editor_clear(&editor);
    type("\033[A\033[B\033[B");
    CHECK(line_is(""));
}

static void stop_key(void) {
    begin();
    type("aim 1\033[\003");
    CHECK(stops == 1U && line_is("") && showed("aim 1^C\r\n"));
    type("x");
    CHECK(line_is("x") && showed("x"));
}

static void a_full_line(void) {
    begin();
    for (uint32_t i = 0; i < LINE_EDITOR_BYTES; i++) {
        type("x");
    }
    echo.size_bytes = 0;
    type("y");
    CHECK(editor.line.size_bytes == LINE_EDITOR_BYTES && showed("\a"));
    type("\001y");
    CHECK(editor.line.text[0] == 'x');
    type("\004y");
    CHECK(editor.line.text[0] == 'y');
}

static void any_bytes(void) {
    uint64_t state = 815;
    check_note("seed", (int64_t)state);
    begin();
    for (uint32_t i = 0; i < 2000000U; i++) {
        static const uint8_t likely[] =
            "\033[ABCDHF~1348O;\001\002\004\005\006\013\025\027\020\016x";
        const uint64_t random = check_random(&state);
        const uint8_t key = (random & 1U) != 0U ? (uint8_t)(random >> 32)
                                                : likely[(random >> 32) % (sizeof likely - 1U)];
        echo.size_bytes = 0;
        if (line_editor_take(&editor, key, &echo) == LINE_EDITOR_LINE) {
            line_editor_clear(&editor);
        }
        if (!CHECK(editor.cursor <= editor.line.size_bytes &&
                   editor.line.size_bytes <= LINE_EDITOR_BYTES &&
                   echo.size_bytes <= LINE_EDITOR_ECHO_BYTES)) {
            return;
        }
    }
}

int main(void) {
    TEST(plain_typing);
    TEST(corrections);
    TEST(the_last_lines);
    TEST(stop_key);
    TEST(a_full_line);
    TEST(any_bytes);
    return check_finish();
}

/// link/line_splitter: keys and checked lines on one line, and what damage costs.
#include "check.h"

#include "link/line_splitter.h"

static struct line_splitter splitter;

static struct {
    char keys[64];
    uint32_t key_count, lines, damaged;
    char type;
} seen;

static void take(uint8_t byte) {
    switch (line_splitter_take(&splitter, byte)) {
    case LINE_SPLITTER_KEY:
        if (seen.key_count < sizeof seen.keys) {
            seen.keys[seen.key_count] = (char)byte;
        }
        seen.key_count++;
        break;
    case LINE_SPLITTER_LINE:
        seen.lines++;
        seen.type = splitter.line.type;
        break;
    case LINE_SPLITTER_DAMAGED:
        seen.damaged++;
        break;
    default:
        break;
    }
}

static void feed(const char *text) {
    for (uint32_t i = 0; text[i] != '\0'; i++) {
        take((uint8_t)text[i]);
    }
}

static void begin(void) {
    line_splitter_init(&splitter);
    seen.key_count = seen.lines = seen.damaged = 0;
}

static bool keys(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < seen.key_count && seen.keys[i] == wanted[i]) {
        i++;
    }
    return wanted[i] == '\0' && i == seen.key_count;
}

#define GOOD "$3f1acarm*c96c"

static void tells_them_apart(void) {
    begin();
    feed("help\r" GOOD "\nsta" GOOD "\r\ntus\r\n" GOOD "\rx\n" GOOD "\n\n");
    CHECK(keys("help\rstatus\r\nx\n\n"));
    CHECK(seen.lines == 4U && seen.damaged == 0U);
}

static void damage_costs_its_line_only(void) {
    static const char *const damage[] = {"$3f1acarm*c96d\n",
                                         "$3f1acar*c96c\n",
                                         "$3f1ac\x01rm*c96c\n",
                                         "$3f1ac\xe9rm*c96c\n",
                                         "$",
                                         "$3f1acarm",
                                         "$$",
                                         "$\n",
                                         "$3f1acarm*c96c",
                                         "$3f1acarm*c96c\t",
                                         "$3f1acarm\x1b[A*\r"};
    for (unsigned i = 0; i < sizeof damage / sizeof damage[0]; i++) {
        begin();
        feed(damage[i]);
        feed(GOOD "\n");
        CHECK(seen.lines == 1U && seen.key_count == 0U);
        CHECK(seen.damaged >= 1U && seen.damaged <= 2U && splitter.damaged == seen.damaged);
    }
}

static void a_line_without_end(void) {
    begin();
    feed("$");
    for (uint32_t i = 0; i < 100000U; i++) {
        take('a');
    }
    CHECK(seen.key_count == 0U && seen.damaged == 1U);
    feed(GOOD "\n");
    CHECK(seen.lines == 1U);
}

/// What lost its `$` is typed by nobody: it comes as keys, but a command does not come of it.
static void a_lost_start(void) {
    begin();
    feed("3f1acarm*c96c\n");
    CHECK(keys("3f1acarm*c96c\n") && seen.lines == 0U);
}

static void stop_is_never_waited_for(void) {
    begin();
    feed("$3f1aca\003" GOOD "\n");
    CHECK(keys("\003") && seen.lines == 1U && seen.damaged == 0U && splitter.damaged == 1U);
    begin();
    feed("$\x80"
         "abc\003abc");
    CHECK(keys("\003abc"));
}

/// Noise of every kind between good lines: each good line is read, and no key is made of what
/// belongs to a damaged one.
static void noise(void) {
    uint64_t state = 20261122;
    check_note("seed", (int64_t)state);
    begin();
    for (uint32_t round = 0; round < 20000U; round++) {
        const uint32_t size = (uint32_t)(check_random(&state) % 300U);
        for (uint32_t i = 0; i < size; i++) {
            const uint64_t random = check_random(&state);
            static const char likely[] = "$*\r\n\003" GOOD;
            take((random & 3U) != 0U ? (uint8_t)(random >> 32)
                                     : (uint8_t)likely[(random >> 32) % (sizeof likely - 1U)]);
        }
        const uint32_t before = seen.lines;
        seen.type = 0;
        feed(GOOD "\n");
        if (!CHECK(seen.lines == before + 1U && seen.type == 'c')) {
            return;
        }
        // One byte of a good line changed, lost or doubled.
        const char *line = GOOD "\n";
        const uint32_t at = (uint32_t)(check_random(&state) % 15U);
        const uint32_t kind = (uint32_t)(check_random(&state) % 3U);
        const uint8_t other = (uint8_t)(check_random(&state) >> 32);
        for (uint32_t i = 0; i < 15U; i++) {
            if (i != at) {
                take((uint8_t)line[i]);
            } else if (kind == 0U && other != (uint8_t)line[i]) {
                take(other);
            } else if (kind == 2U) {
                take((uint8_t)line[i]);
                take((uint8_t)line[i]);
            }
        }
        // A doubled `$` or end and a CR for the LF leave a good line.
        const bool harmless =
            (kind == 2U && (at == 0U || at == 14U)) || (kind == 0U && at == 14U && other == '\r');
        if (!CHECK(seen.lines <= before + 1U + harmless)) {
            return;
        }
    }
    check_note("good lines", seen.lines);
    check_note("damaged lines", seen.damaged);
}

int main(void) {
    TEST(tells_them_apart);
    TEST(damage_costs_its_line_only);
    TEST(a_line_without_end);
    TEST(a_lost_start);
    TEST(stop_is_never_waited_for);
    TEST(noise);
    return check_finish();
}

#include "check.h"

static struct { unsigned passed, failed, failed_here; } tally;

static void write_text(const char *text) {
    size_t size = 0;
    while (text[size] != '\0') {
        size++;
    }
    check_write(text, size);
}

static void write_number(int64_t value) {
    char digits[24];
    size_t at = sizeof digits;
    uint64_t rest = value < 0 ? 0U - (uint64_t)value : (uint64_t)value;
    do {
        digits[--at] = (char)('0' + rest % 10U);
        rest /= 10U;
    } while (rest != 0U);
    if (value < 0) {
        digits[--at] = '-';
    }
    check_write(digits + at, sizeof digits - at);
}

static void write_place(const char *file, int line, const char *text) {
    tally.failed_here++;
    write_text("  ");
    write_text(file);
    write_text(":");
    write_number(line);
    write_text(": ");
    write_text(text);
}

bool check_true(const char *file, int line, const char *text, bool condition) {
    if (!condition) {
        write_place(file, line, text);
        write_text(" is false\n");
    }
    return condition;
}

bool check_near(const char *file, int line, const char *text, int64_t got, int64_t wanted,
                int64_t tolerance) {
    const uint64_t apart =
        got > wanted ? (uint64_t)got - (uint64_t)wanted : (uint64_t)wanted - (uint64_t)got;
    if (apart <= (uint64_t)tolerance) {
        return true;
    }
    write_place(file, line, text);
    write_text(" is ");
    write_number(got);
    write_text(", not ");
    write_number(wanted);
    if (tolerance != 0) {
        write_text(" within ");
        write_number(tolerance);
    }
    write_text("\n");
    return false;
}

bool check_equal(const char *file, int line, const char *text, int64_t got, int64_t wanted) {
    return check_near(file, line, text, got, wanted, 0);
}

bool check_clean(void) {
    return tally.failed_here == 0U;
}

void check_run(const char *name, void (*function)(void)) {
    tally.failed_here = 0;
    function();
    if (check_clean()) {
        tally.passed++;
        write_text("ok ");
    } else {
        tally.failed++;
        write_text("FAIL ");
    }
    write_text(name);
    write_text("\n");
}

void check_run_timed(const char *name, void (*function)(void), const char *(*excuse)(void)) {
    const char *why = "";
    (void)excuse(); // what was before is over
    for (unsigned tries = 0; tries < 3U && why != NULL; tries++) {
        tally.failed_here = 0;
        function();
        why = check_clean() ? NULL : excuse();
    }
    if (why == NULL) {
        tally.passed += check_clean() ? 1U : 0U;
        tally.failed += check_clean() ? 0U : 1U;
    }
    write_text(why != NULL ? "SKIP " : check_clean() ? "ok " : "FAIL ");
    write_text(name);
    write_text(why != NULL ? ": " : "");
    write_text(why != NULL ? why : "");
    write_text("\n");
}

void check_note(const char *text, int64_t value) {
    write_text("# ");
    write_text(text);
    write_text(" ");
    write_number(value);
    write_text("\n");
}

int check_finish(void) {
    write_text("# passed ");
    write_number(tally.passed);
    write_text(" failed ");
    write_number(tally.failed);
    write_text("\n");
    return tally.failed == 0U ? 0 : 1;
}

/// A test program is a main() that calls TEST for each named test and returns check_finish().
///
/// Why our own and no library: the same unit tests run on emulated Cortex-M boards, where there is
/// no libc. Output: one line a test, `ok NAME` or `FAIL NAME` after a line for each failed check;
/// the runner (tests/run.sh) counts these lines, so a program that dies early is noticed by its
/// exit status.
#ifndef TESTS_CHECK_H
#define TESTS_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Runs `void name(void)` and prints its verdict.
#define TEST(function) check_run(#function, function)

#define CHECK(condition) check_true(__FILE__, __LINE__, #condition, (condition))
#define CHECK_EQ(got, wanted)                                                                      \
    check_equal(__FILE__, __LINE__, #got, (int64_t)(got), (int64_t)(wanted))
/// |got - wanted| <= tolerance, in integers.
#define CHECK_NEAR(got, wanted, tolerance)                                                         \
    check_near(__FILE__, __LINE__, #got, (int64_t)(got), (int64_t)(wanted), (int64_t)(tolerance))

/// Each returns whether the check held, so that a loop can stop at its first failure.
bool check_true(const char *file, int line, const char *text, bool condition);
bool check_equal(const char *file, int line, const char *text, int64_t got, int64_t wanted);
bool check_near(const char *file, int line, const char *text, int64_t got, int64_t wanted,
                int64_t tolerance);

void check_run(const char *name, void (*function)(void));

/// The same for a test of real time, which proves nothing on a machine that paused. excuse: asked
/// when the test has failed, tells that it did, since it was asked last (NULL: it didn't). Then the
/// test is run again; after three times it is skipped, by name and for that reason.
void check_run_timed(const char *name, void (*function)(void), const char *(*excuse)(void));

/// True while the running test has no failed check.
bool check_clean(void);

/// Prints `# passed N failed M`; 0 if none failed, else 1.
int check_finish(void);

/// Prints a note: what was measured, which seed ran. `# TEXT VALUE`.
void check_note(const char *text, int64_t value);

/// xorshift64*: the same numbers on every machine. state must not be 0.
static inline uint64_t check_random(uint64_t *state) {
    uint64_t x = *state;
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return x * UINT64_C(0x2545F4914F6CDD1D);
}

/// Random tests with many rounds take so many of them: fewer on slow machines, whose builds set
/// CHECK_SHARE.
#ifndef CHECK_SHARE
#define CHECK_SHARE 1
#endif
#define CHECK_ROUNDS(count) ((count) / CHECK_SHARE)

/// Where the text goes: supplied by check_host.c, or by the start-up code of an emulated board.
void check_write(const char *text, size_t size);

#endif

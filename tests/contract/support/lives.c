#include "contract/support/lives.h"

#include "check.h"
#include "contract/support/syscalls.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/// A life has fewer calls.
#define CALLS_MAX 2000U
/// What can't be had from these is HAL_ERROR_IO, whatever the error is.
static const char without_reason[] =
    "pthread_create flock libusb_alloc_transfer libusb_get_pollfds";

static struct life {
    char said[8000];
    size_t size;
    enum hal_status first_failure; ///< HAL_OK: there was none
    bool has_line;
    char line[LINUX_ERROR_BYTES];
} now, usual;

static void say(const char *what, int64_t value) {
    const size_t room = sizeof now.said - now.size;
    const int size = snprintf(now.said + now.size, room, "%s %lld\n", what, (long long)value);
    if (CHECK(size > 0 && (size_t)size < room)) {
        now.size += (size_t)size;
    }
}

enum hal_status life_note(const char *what, enum hal_status status,
                          const struct linux_error *error) {
    return life_note_refusal(what, status, HAL_OK, error);
}

enum hal_status life_note_refusal(const char *what, enum hal_status status, enum hal_status wanted,
                                  const struct linux_error *error) {
    say(what, status);
    if (status != wanted && now.first_failure == HAL_OK) {
        now.first_failure = status;
        now.has_line = error != NULL;
        snprintf(now.line, sizeof now.line, "%s", error != NULL ? error->line : "");
    }
    return status;
}

void life_value(const char *what, int64_t value) {
    say(what, value);
}

/// What must be as before when a life is over.
struct leftovers {
    uint32_t files, mappings, threads;
};

static struct leftovers look(void) {
    return (struct leftovers){syscalls_open_files(), syscalls_mappings(), syscalls_threads()};
}

/// A thread that has been joined is there for a moment yet.
static void expect_no_leftovers(const struct leftovers *before) {
    struct leftovers after = look();
    for (int ms = 0; ms < 10000 && after.threads > before->threads; ms++) {
        usleep(1000);
        after = look();
    }
    CHECK_EQ(after.files, before->files);
    CHECK_EQ(after.mappings, before->mappings);
    CHECK_EQ(after.threads, before->threads);
}

static void live(const struct lives *lives) {
    memset(&now, 0, sizeof now);
    lives->live();
}

static void expect_usual(const char *when) {
    if (!CHECK(strcmp(now.said, usual.said) == 0)) {
        size_t at = 0;
        while (at < now.size && now.said[at] == usual.said[at]) {
            at++;
        }
        while (at > 0U && now.said[at - 1U] != '\n') {
            at--;
        }
        printf("  %s: said  %.*s\n  usual %.*s\n  line  %s\n", when,
               (int)strcspn(now.said + at, "\n"), now.said + at,
               (int)strcspn(usual.said + at, "\n"), usual.said + at, now.line);
    }
}

/// The life that is over had a failure in it.
static void expect_reported(const struct lives *lives, const struct life_error *error,
                            const char *name) {
    if (now.first_failure == usual.first_failure) {
        expect_usual(name);
        return;
    }
    CHECK((error->statuses & LIFE_STATUS(now.first_failure)) != 0U ||
          (strstr(without_reason, name) != NULL && now.first_failure == HAL_ERROR_IO));
    const bool needs_line = now.has_line && now.first_failure < HAL_ERROR_ARGUMENT;
    CHECK(!needs_line || strstr(now.line, lives->device) != NULL);
}

/// first: of the errors, which are so many.
static void each_failure(const struct lives *lives, const struct life_error *first, uint32_t count,
                         enum syscalls_fate fate, const struct leftovers *before) {
    bool met = true;
    const uint32_t every = lives->recover_every > 1U ? lives->recover_every : 1U;
    const uint32_t stride = lives->stride > 1U ? lives->stride : 1U;
    for (uint32_t nth = 1; met && nth < CALLS_MAX && check_clean(); nth += stride) {
        char name[40];
        const struct life_error *error = &first[nth / stride % count];
        syscalls_at(nth, fate, error->error_number);
        live(lives);
        met = syscalls_met();
        snprintf(name, sizeof name, "%s", syscalls_met_name());
        syscalls_at(0, SYSCALLS_FAIL, 0);
        if (fate == SYSCALLS_FAIL) {
            expect_reported(lives, error, name);
        }
        expect_no_leftovers(before);
        if (nth / stride % every == 0U || !met) {
            const struct life failed = now;
            live(lives);
            expect_usual("the next life");
            now = failed;
        }
        if (!check_clean()) {
            printf("  call %u, %s, failed with %d%s: %s\n", (unsigned)nth, name,
                   error->error_number, fate == SYSCALLS_FAIL ? "" : " and all after it", now.said);
        }
    }
    CHECK(!met);
}

void lives_each_failure(const struct lives *lives) {
    syscalls_spare(lives->spared);
    live(lives); // libraries may keep something from their first use on
    const struct leftovers before = look();
    syscalls_at(0, SYSCALLS_FAIL, 0);
    live(lives);
    check_note("calls in a life, to fail one by one", syscalls_count());
    usual = now;
    CHECK(syscalls_count() > 3U);
    expect_no_leftovers(&before);
    const uint32_t step = lives->share_out ? lives->error_count : 1U;
    for (uint32_t i = 0; i < lives->error_count && check_clean(); i += step) {
        each_failure(lives, &lives->errors[i], step, SYSCALLS_FAIL, &before);
    }
    for (uint32_t i = 0; i < lives->error_count && lives->dies && check_clean(); i += step) {
        each_failure(lives, &lives->errors[i], step, SYSCALLS_FAIL_ON, &before);
    }
    syscalls_spare(NULL);
}

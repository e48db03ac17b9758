/// The flash file of hal/linux: its contract, its error lines, and that it survives being killed
/// and any system call that fails.
#include "linux/linux_flash_file.h"
#include "contract/support/contract.h"
#include "contract/support/flash_suite.h"
#include "contract/support/syscalls.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static struct linux_flash_file flash;
static struct hal_flash_geometry geometry;
static char directory[] = "build/flash-XXXXXX", path[64], new_path[80];

static void settle(void *context) {
    (void)context;
    nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
}

/// Between suite and driver: makes the first system call of the nth call fail. A call that answers
/// HAL_BUSY does not count.
static struct {
    uint32_t nth;
    int error_number;
} order;

static void before_call(void) {
    syscalls_at(order.nth == 1U ? 1U : 0U, SYSCALLS_FAIL, order.error_number);
}

static enum hal_status after_call(enum hal_status status) {
    syscalls_at(0, SYSCALLS_FAIL, 0);
    order.nth -= order.nth != 0U && status != HAL_BUSY ? 1U : 0U;
    return status;
}

static enum hal_status watched_geometry(void *ctx, struct hal_flash_geometry *got) {
    (void)ctx;
    return hal_flash_geometry(&flash.hal, got);
}

static enum hal_status watched_read(void *ctx, uint32_t address, uint8_t *data, uint32_t count) {
    (void)ctx;
    before_call();
    return after_call(hal_flash_read(&flash.hal, address, data, count));
}

static enum hal_status watched_program(void *ctx, uint32_t address, const uint8_t *data,
                                       uint32_t count) {
    (void)ctx;
    before_call();
    return after_call(hal_flash_program(&flash.hal, address, data, count));
}

static enum hal_status watched_erase(void *ctx, uint32_t sector) {
    (void)ctx;
    before_call();
    return after_call(hal_flash_erase(&flash.hal, sector));
}

static enum hal_status watched_poll(void *ctx) {
    (void)ctx;
    before_call();
    return after_call(hal_flash_poll(&flash.hal));
}

static const struct hal_flash_ops watched_ops = {watched_geometry, watched_read, watched_program,
                                                 watched_erase, watched_poll};

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    order.nth = nth;
    order.error_number = status == HAL_ERROR_GONE ? ENODEV : EIO;
    return true;
}

static void reset(void *context) {
    (void)context;
    fail_at(NULL, 0, HAL_OK);
    syscalls_at(0, SYSCALLS_FAIL, 0);
    linux_flash_file_close(&flash);
    if (!CHECK_EQ(linux_flash_file_open(&flash, path, &geometry), HAL_OK)) {
        printf("  %s\n", flash.error.line);
        exit(1);
    }
}

static void test_suite(const char *name, struct hal_flash_geometry with) {
    linux_flash_file_close(&flash);
    unlink(path);
    geometry = with;
    reset(NULL);
    struct hal_flash watched;
    CHECK_EQ(hal_flash_bind(&watched, &watched_ops, &flash), HAL_OK);
    flash_suite(&(struct flash_fixture){.name = name,
                                        .flash = &watched,
                                        .geometry = with,
                                        .reset = reset,
                                        .settle = settle,
                                        .reopen = reset,
                                        .fail_at = fail_at});
}

static enum hal_status finish(void) {
    enum hal_status status = HAL_BUSY;
    for (int i = 0; i < 100000 && status == HAL_BUSY; i++) {
        status = hal_flash_poll(&flash.hal);
        if (status == HAL_BUSY) {
            settle(NULL);
        }
    }
    return status;
}

static void begin_afresh(void) {
    syscalls_at(0, SYSCALLS_FAIL, 0);
    linux_flash_file_close(&flash);
    unlink(path);
    unlink(new_path);
}

/// The whole file, read by the C library. size gets 0 if there is none.
static void slurp(const char *name, uint8_t *data, size_t capacity, size_t *size) {
    FILE *file = fopen(name, "rb");
    *size = 0;
    if (file != NULL) {
        *size = fread(data, 1, capacity, file);
        fclose(file);
    }
}

static void the_file_is_the_flash(void) {
    begin_afresh();
    reset(NULL);
    uint8_t image[600], byte[4] = {0x12, 0x34, 0x56, 0x78};
    size_t size;
    slurp(path, image, sizeof image, &size);
    CHECK_EQ(size, 512);
    for (size_t i = 0; i < size; i++) {
        CHECK_EQ(image[i], HAL_FLASH_ERASED);
    }
    CHECK_EQ(hal_flash_program(&flash.hal, 8, byte, sizeof byte), HAL_OK);
    CHECK_EQ(finish(), HAL_OK);
    slurp(path, image, sizeof image, &size);
    CHECK_EQ(size, 512);
    CHECK(memcmp(image + 8, byte, sizeof byte) == 0 && image[7] == 0xFFU && image[12] == 0xFFU);
    CHECK_EQ(access(new_path, F_OK), -1);
}

// ------------------------------------------------------------------------------- lines for people
static void expect_refusal(const char *name, enum hal_status wanted, const char *reason) {
    struct linux_flash_file refused;
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line, "%s: %s", name, reason);
    CHECK_EQ(linux_flash_file_open(&refused, name, &geometry), wanted);
    if (!CHECK(strcmp(refused.error.line, line) == 0)) {
        printf("  got    %s\n  wanted %s\n", refused.error.line, line);
    }
    CHECK_EQ(refused.fd, -1);
    linux_flash_file_close(&refused);
}

static void refusals(void) {
    begin_afresh();
    reset(NULL);
    expect_refusal(path, HAL_ERROR_DENIED,
                   "in use by another program; end that one first (`fuser -v` on the file shows "
                   "it)");
    linux_flash_file_close(&flash);
    CHECK_EQ(truncate(path, 511), 0);
    expect_refusal(path, HAL_ERROR_UNSUPPORTED,
                   "has 511 bytes, not the 512 of a settings file; move it away and start again to "
                   "make a new one");
    expect_refusal("build/no/such/settings", HAL_ERROR_GONE,
                   "no such file or device; create its directory");
    expect_refusal("build", HAL_ERROR_UNSUPPORTED, "is a folder; name a file in it");
    expect_refusal("/dev/null", HAL_ERROR_UNSUPPORTED, "not a regular file; name another file");
    const struct hal_flash_geometry good = geometry;
    const struct hal_flash_geometry bad[] = {{0, 256, 4},       {2, 0, 4},          {2, 256, 0},
                                             {2, 256, 3},       {2, 254, 4},        {2, 4, 8},
                                             {65536, 65536, 4}, {0x80000000U, 2, 1}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        geometry = bad[i];
        expect_refusal(path, HAL_ERROR_ARGUMENT, "impossible geometry; name another file");
    }
    geometry = good;
    char name[LINUX_FLASH_FILE_PATH_BYTES + 1];
    memset(name, 'x', sizeof name);
    name[sizeof name - 1U] = '\0';
    CHECK_EQ(linux_flash_file_open(&flash, name, &geometry), HAL_ERROR_ARGUMENT);
    CHECK(strstr(flash.error.line, "xxx: the name is too long") != NULL);
}

/// Settings that go to a file without a name are lost; a file cut short has none.
static void deleted_and_cut_files(void) {
    begin_afresh();
    reset(NULL);
    uint8_t data[4] = {0};
    CHECK_EQ(truncate(path, 100), 0);
    CHECK_EQ(hal_flash_read(&flash.hal, 98, data, 4), HAL_ERROR_IO);
    CHECK(strstr(flash.error.line, ": the file has been cut short; ") != NULL);
    CHECK_EQ(hal_flash_program(&flash.hal, 256, data, 4), HAL_ERROR_IO);
    CHECK_EQ(unlink(path), 0);
    CHECK_EQ(hal_flash_read(&flash.hal, 0, data, 4), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_program(&flash.hal, 0, data, 4), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_erase(&flash.hal, 0), HAL_ERROR_GONE);
    CHECK(strstr(flash.error.line, ": the file has been deleted; start again ") != NULL);
    linux_flash_file_close(&flash);
    struct hal_flash_geometry got;
    CHECK_EQ(hal_flash_geometry(&flash.hal, &got), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_poll(&flash.hal), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_read(&flash.hal, 0, data, 4), HAL_ERROR_GONE);
}

// ---------------------------------------------------------------------- one life of a settings
// file

#define SIZE  512U
#define STEPS 4U

/// What each step makes of the flash: program, program more than a page, erase, program again.
static const struct {
    uint32_t address, size_bytes;
    uint8_t value;
} steps[STEPS] = {{4, 8, 0x5A}, {256, 256, 0x11}, {0, 256, HAL_FLASH_ERASED}, {0, 64, 0x00}};

/// Opens the file and takes the steps; *step is the one under way. Stops at the first failure.
static enum hal_status live(volatile uint32_t *step) {
    static uint8_t data[SIZE];
    *step = 0;
    enum hal_status status = linux_flash_file_open(&flash, path, &geometry);
    for (uint32_t i = 0; i < STEPS && status == HAL_OK; i++) {
        *step = i + 1U;
        memset(data, steps[i].value, steps[i].size_bytes);
        status = steps[i].value == HAL_FLASH_ERASED
                     ? hal_flash_erase(&flash.hal, steps[i].address / geometry.sector_bytes)
                     : hal_flash_program(&flash.hal, steps[i].address, data, steps[i].size_bytes);
        if (status == HAL_OK) {
            status = finish();
        }
    }
    if (status == HAL_OK) {
        *step = STEPS + 1U;
    }
    return status;
}

/// The file after a life that ended in that step: all before it is done, it itself in part or not
/// or wholly, nothing after it.
static void expect_remains(uint32_t step) {
    uint8_t old[SIZE], now[SIZE], after[SIZE];
    memset(old, HAL_FLASH_ERASED, SIZE);
    for (uint32_t i = 0; i + 1U < step && i < STEPS; i++) {
        memset(old + steps[i].address, steps[i].value, steps[i].size_bytes);
    }
    memcpy(after, old, SIZE);
    if (step >= 1U && step <= STEPS) {
        memset(after + steps[step - 1U].address, steps[step - 1U].value,
               steps[step - 1U].size_bytes);
    }
    reset(NULL); // it opens, whatever happened
    CHECK_EQ(hal_flash_read(&flash.hal, 0, now, SIZE), HAL_OK);
    bool seen_old = false;
    for (uint32_t i = 0; i < SIZE && check_clean(); i++) {
        CHECK(now[i] == old[i] || now[i] == after[i]);
        if (old[i] != after[i]) { // done in ascending order
            seen_old = seen_old || now[i] == old[i];
            CHECK(!seen_old || now[i] == old[i]);
        }
    }
}

static void killed_at_every_system_call(void) {
    volatile uint32_t *step =
        mmap(NULL, sizeof *step, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    CHECK(step != MAP_FAILED);
    uint32_t kills = 0, torn = 0;
    for (int fate = SYSCALLS_KILL_BEFORE; fate <= SYSCALLS_KILL_AFTER; fate++) {
        bool killed = true;
        for (uint32_t nth = 1; killed && check_clean(); nth++) {
            begin_afresh();
            const pid_t child = fork();
            if (child == 0) {
                syscalls_at(nth, (enum syscalls_fate)fate, 0);
                _exit(live(step) == HAL_OK ? 0 : 1);
            }
            int status = 0;
            CHECK(child > 0 && waitpid(child, &status, 0) == child);
            killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
            CHECK(killed || (WIFEXITED(status) && WEXITSTATUS(status) == 0));
            kills += killed ? 1U : 0U;
            expect_remains(*step);
            uint8_t now[SIZE];
            CHECK_EQ(hal_flash_read(&flash.hal, 0, now, SIZE), HAL_OK);
            torn += now[256] != now[511] ? 1U : 0U;
        }
        CHECK_EQ(*step, STEPS + 1U);
    }
    check_note("kills", kills);
    CHECK(kills > 60U);
    CHECK(torn > 0U);
    munmap((void *)(uintptr_t)step, sizeof *step);
}

/// Any call fails with any of these: the step says so, with a line, and the file is as sound as
/// after a kill; the next life goes well.
static void failing_at_every_system_call(void) {
    const int errors[] = {EIO, ENOSPC, EBUSY, EACCES, EINTR};
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++) {
        bool met = true;
        uint32_t nth = 1, done_again = 0;
        for (; met && check_clean(); nth++) {
            begin_afresh();
            volatile uint32_t step = 0;
            const uint32_t open_files = syscalls_open_files();
            syscalls_at(nth, SYSCALLS_FAIL, errors[i]);
            const enum hal_status status = live(&step);
            met = syscalls_met();
            syscalls_at(0, SYSCALLS_FAIL, 0);
            CHECK(met || status == HAL_OK);
            CHECK(status != HAL_ERROR_ARGUMENT && status != HAL_BUSY && status != HAL_EMPTY);
            done_again += met && status == HAL_OK ? 1U : 0U;
            CHECK(status == HAL_OK || strncmp(flash.error.line, path, strlen(path)) == 0);
            linux_flash_file_close(&flash);
            CHECK_EQ(syscalls_open_files(), open_files);
            expect_remains(step);
        }
        CHECK(nth > 30U);
        // A read or write that is interrupted is done again; there are no other second chances.
        CHECK(errors[i] == EINTR ? done_again >= 8U : done_again <= 1U);
    }
}

/// What only one of two can have: the other is told, and harms nothing.
static void two_create_at_once(void) {
    begin_afresh();
    const int other = open(new_path, O_RDWR | O_CREAT, 0600); // another program is creating it
    CHECK_EQ(write(other, "half", 4), 4);
    CHECK_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
    expect_refusal(path, HAL_ERROR_DENIED,
                   "in use by another program; end that one first (`fuser -v` on the file shows "
                   "it)");
    struct stat about;
    CHECK(fstat(other, &about) == 0 && about.st_size == 4);
    CHECK_EQ(ftruncate(other, 5 * SIZE), 0);
    close(other); // it died, and wanted another size: what it left is made anew
    reset(NULL);
    CHECK(stat(path, &about) == 0 && about.st_size == (off_t)SIZE);
}

/// The other program: as careful as ours, with its own code. It makes a file full of 0x77.
static bool other_made_it, other_leaves_a_second;

static void other_creates(void) {
    other_made_it = false;
    const int fd = open(new_path, O_RDWR | O_CREAT, 0600);
    struct stat about;
    if (flock(fd, LOCK_EX | LOCK_NB) == 0 && stat(path, &about) != 0) {
        uint8_t data[SIZE];
        memset(data, 0x77, SIZE);
        if (other_leaves_a_second) {
            CHECK_EQ(unlink(new_path), 0);
            close(open(new_path, O_RDWR | O_CREAT, 0600)); // begun by a third one
        } else {
            CHECK_EQ(pwrite(fd, data, SIZE, 0), SIZE);
            CHECK_EQ(rename(new_path, path), 0);
            other_made_it = true;
        }
    }
    close(fd);
}

/// Wherever the other comes in between: what it made stays, and we work on the named file or not at
/// all.
static void somebody_else_creates_it_meanwhile(void) {
    syscalls_intruder(other_creates);
    uint32_t made = 0;
    for (int second = 0; second < 2; second++) {
        other_leaves_a_second = second == 1;
        bool met = true;
        for (uint32_t nth = 1; met && check_clean(); nth++) {
            begin_afresh();
            syscalls_at(nth, SYSCALLS_INTRUDE, 0);
            const enum hal_status status = linux_flash_file_open(&flash, path, &geometry);
            met = syscalls_met();
            syscalls_at(0, SYSCALLS_FAIL, 0);
            CHECK(status == HAL_OK || status == HAL_ERROR_DENIED);
            struct stat named, ours;
            if (status == HAL_OK) {
                CHECK(stat(path, &named) == 0 && fstat(flash.fd, &ours) == 0);
                CHECK(named.st_ino == ours.st_ino && named.st_size == (off_t)SIZE);
            }
            if (met && other_made_it) {
                made++;
                uint8_t data[SIZE];
                size_t size;
                slurp(path, data, SIZE, &size);
                CHECK(size == SIZE && data[0] == 0x77U && data[SIZE - 1U] == 0x77U);
            }
        }
    }
    CHECK(made >= 3U);
}

/// Against power failures: the disk has the whole file before it gets its name, then the name; each
/// operation is waited for; and what a killed program left is on the disk before it is believed.
static void disk_is_waited_for(void) {
    begin_afresh();
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(linux_flash_file_open(&flash, path, &geometry), HAL_OK);
    CHECK(strcmp(syscalls_log(), "open open flock fstat access ftruncate pwrite fsync rename open "
                                 "fsync close ") == 0);
    const uint8_t data[4] = {0};
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(hal_flash_program(&flash.hal, 0, data, 4), HAL_OK);
    CHECK_EQ(finish(), HAL_OK);
    CHECK_EQ(hal_flash_erase(&flash.hal, 0), HAL_OK);
    CHECK_EQ(finish(), HAL_OK);
    CHECK(strcmp(syscalls_log(), "fstat pread pwrite aio_fsync aio_error fstat pwrite aio_fsync "
                                 "aio_error ") == 0);
    linux_flash_file_close(&flash);
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(linux_flash_file_open(&flash, path, &geometry), HAL_OK);
    CHECK(strcmp(syscalls_log(), "open flock fstat fdatasync ") == 0);
}

int main(void) {
    if (mkdir("build", 0777) != 0 && errno != EEXIST) {
        perror("build");
        return 2;
    }
    if (mkdtemp(directory) == NULL) {
        perror(directory);
        return 2;
    }
    snprintf(path, sizeof path, "%s/settings", directory);
    snprintf(new_path, sizeof new_path, "%s.new", path);
    flash.fd = -1;
    geometry = (struct hal_flash_geometry){2, 256, 4};
    // First of all: a child can't use the threads with which its parent waited for the disk.
    CONTRACT("linux_flash", killed_at_every_system_call);
    test_suite("linux_flash_words", (struct hal_flash_geometry){4, 1024, 4});
    test_suite("linux_flash_pages", (struct hal_flash_geometry){2, 8192, 256});
    geometry = (struct hal_flash_geometry){2, 256, 4};
    CONTRACT("linux_flash", the_file_is_the_flash);
    CONTRACT("linux_flash", refusals);
    CONTRACT("linux_flash", deleted_and_cut_files);
    CONTRACT("linux_flash", failing_at_every_system_call);
    CONTRACT("linux_flash", two_create_at_once);
    CONTRACT("linux_flash", somebody_else_creates_it_meanwhile);
    CONTRACT("linux_flash", disk_is_waited_for);
    begin_afresh();
    rmdir(directory);
    return check_finish();
}

/// What the fake flash does beyond the contract: power cuts at every operation, torn and unstable
/// bits, bit rot.
#include "devices/fake_flash.h"
#include "check.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define UNIT   8U
#define SECTOR 64U
#define SIZE   (2U * SECTOR)
#define UNITS  4U

static struct fake_flash flash;
static uint8_t memory[SIZE], before[SIZE], wanted[SIZE];

/// Both sectors full of old data, in which every other bit can still fall.
static void new_flash(uint64_t seed) {
    const struct hal_flash_geometry geometry = {2, SECTOR, UNIT};
    memset(memory, 0xAA, SIZE);
    memcpy(before, memory, SIZE);
    fake_flash_init(&flash, &geometry, memory, seed);
}

/// Programs UNITS units from the second one on, then erases the other sector: 5 operations.
static enum hal_status write_some(void) {
    static const uint8_t data[UNITS * UNIT] = {0x2A, 0x8A, 0xA2, 0xA8, 0x00, 0xAA, 0x0A, 0xA0};
    memcpy(wanted, before, SIZE);
    memcpy(wanted + UNIT, data, sizeof data);
    enum hal_status status = hal_flash_program(&flash.hal, UNIT, data, sizeof data);
    if (status == HAL_OK) {
        status = hal_flash_poll(&flash.hal);
    }
    if (status == HAL_OK) {
        status = hal_flash_erase(&flash.hal, 1);
    }
    memset(wanted + SECTOR, HAL_FLASH_ERASED, SECTOR);
    return status == HAL_OK ? hal_flash_poll(&flash.hal) : status;
}

static void expect_dead(void) {
    uint8_t byte = 0;
    struct hal_flash_geometry geometry;
    CHECK_EQ(hal_flash_read(&flash.hal, 0, &byte, 1), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_program(&flash.hal, 0, before, UNIT), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_erase(&flash.hal, 0), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_poll(&flash.hal), HAL_ERROR_GONE);
    CHECK_EQ(hal_flash_geometry(&flash.hal, &geometry), HAL_ERROR_GONE);
}

/// Operations before the cut are done, those after it are not.
static void expect_cut(uint32_t nth, enum fake_flash_cut cut) {
    for (uint32_t i = 0; i < SIZE && check_clean(); i++) {
        // Which operation concerns this byte; 0: none.
        const uint32_t operation = i >= SECTOR ? 5U : (i >= UNIT && i < 5U * UNIT ? i / UNIT : 0U);
        const bool done =
            operation < nth || (operation == nth && cut == FAKE_FLASH_CUT_AFTER) || operation == 0U;
        if (operation == nth && cut == FAKE_FLASH_CUT_TORN) {
            CHECK(operation == 5U ||
                  ((memory[i] & wanted[i]) == wanted[i] && (memory[i] | before[i]) == before[i]));
        } else {
            CHECK_EQ(memory[i], done ? wanted[i] : before[i]);
        }
    }
}

static void cut_at_every_operation(void) {
    new_flash(1);
    CHECK_EQ(write_some(), HAL_OK);
    CHECK(memcmp(memory, wanted, SIZE) == 0);
    CHECK_EQ(flash.operation_count, 5);
    CHECK_EQ(flash.erase_count, 1);
    for (uint64_t seed = 1; seed <= 50U; seed++) {
        for (uint32_t nth = 1; nth <= 6U; nth++) {
            for (int cut = FAKE_FLASH_CUT_BEFORE; cut <= FAKE_FLASH_CUT_AFTER; cut++) {
                new_flash(seed);
                fake_flash_cut_at(&flash, nth, (enum fake_flash_cut)cut);
                CHECK_EQ(write_some(), nth <= 5U ? HAL_ERROR_GONE : HAL_OK);
                expect_cut(nth, (enum fake_flash_cut)cut);
                if (nth > 5U) {
                    continue;
                }
                expect_dead();
                CHECK_EQ(flash.operation_count, nth);
                fake_flash_power_on(&flash);
                CHECK_EQ(hal_flash_poll(&flash.hal), HAL_OK);
                CHECK_EQ(write_some(), HAL_OK); // and the same again goes well
                CHECK(memcmp(memory, wanted, SIZE) == 0);
            }
        }
    }
}

/// Power that fails after the call and before the first poll: nothing has happened.
static void cut_while_busy(void) {
    new_flash(1);
    flash.busy_polls = 2;
    const uint8_t zeros[UNIT] = {0};
    CHECK_EQ(hal_flash_program(&flash.hal, 0, zeros, UNIT), HAL_OK);
    CHECK_EQ(hal_flash_poll(&flash.hal), HAL_BUSY);
    CHECK_EQ(hal_flash_erase(&flash.hal, 0), HAL_BUSY);
    fake_flash_power_on(&flash);
    CHECK_EQ(hal_flash_poll(&flash.hal), HAL_OK);
    CHECK(memcmp(memory, before, SIZE) == 0);
}

/// Over the seeds a tear leaves each kind of outcome, and one seed always the same.
static void tears_differ(void) {
    uint32_t untouched = 0, done = 0, mixed = 0, anything = 0;
    for (uint64_t seed = 1; seed <= 200U; seed++) {
        uint8_t first[SIZE];
        new_flash(seed);
        fake_flash_cut_at(&flash, 1, FAKE_FLASH_CUT_TORN);
        CHECK_EQ(write_some(), HAL_ERROR_GONE);
        untouched += memory[UNIT] == before[UNIT];
        done += memory[UNIT] == wanted[UNIT];
        mixed += memory[UNIT + 4U] != 0xAAU && memory[UNIT + 4U] != 0U;
        memcpy(first, memory, SIZE);
        new_flash(seed);
        fake_flash_cut_at(&flash, 1, FAKE_FLASH_CUT_TORN);
        CHECK_EQ(write_some(), HAL_ERROR_GONE);
        CHECK(memcmp(first, memory, SIZE) == 0);
        new_flash(seed);
        fake_flash_cut_at(&flash, 5, FAKE_FLASH_CUT_TORN);
        CHECK_EQ(write_some(), HAL_ERROR_GONE);
        const uint8_t cell = memory[SECTOR];
        anything += cell != HAL_FLASH_ERASED && cell != before[SECTOR];
    }
    CHECK(untouched > 20U && done > 20U && mixed > 100U && anything > 20U);
}

/// An operation that fails to order is done in part: some units, then one torn, then none.
static void fails_in_part(void) {
    uint32_t whole = 0, none = 0, torn = 0;
    for (uint64_t seed = 1; seed <= 100U; seed++) {
        new_flash(seed);
        fake_failures_at(&flash.failures, 2, 1, HAL_ERROR_IO); // the poll
        CHECK_EQ(write_some(), HAL_ERROR_IO);
        CHECK_EQ(flash.operation_count >= 1U && flash.operation_count <= UNITS, true);
        expect_cut(flash.operation_count, FAKE_FLASH_CUT_TORN);
        const uint8_t *unit = memory + flash.operation_count * UNIT;
        const uint8_t *goal = wanted + flash.operation_count * UNIT;
        none += memcmp(unit, before, UNIT) == 0;
        whole += memcmp(unit, goal, UNIT) == 0;
        torn += memcmp(unit, before, UNIT) != 0 && memcmp(unit, goal, UNIT) != 0;
        CHECK_EQ(write_some(), HAL_OK);
        CHECK(memcmp(memory, wanted, SIZE) == 0);
    }
    CHECK(torn > 20U && none + whole < 90U);
}

/// Half-programmed bits read differently each time, all others do not; programming settles them.
static void torn_bits_are_unstable(void) {
    new_flash(7);
    fake_flash_cut_at(&flash, 1, FAKE_FLASH_CUT_TORN);
    CHECK_EQ(write_some(), HAL_ERROR_GONE);
    fake_flash_power_on(&flash);
    uint8_t ever_one[SIZE] = {0}, ever_zero[SIZE] = {0}, now[SIZE];
    for (int i = 0; i < 200; i++) {
        CHECK_EQ(hal_flash_read(&flash.hal, 0, now, SIZE), HAL_OK);
        for (uint32_t k = 0; k < SIZE; k++) {
            ever_one[k] |= now[k];
            ever_zero[k] |= (uint8_t)~now[k];
        }
    }
    uint32_t changing = 0;
    for (uint32_t k = 0; k < SIZE; k++) {
        const unsigned both = ever_one[k] & ever_zero[k];
        const bool torn = k >= UNIT && k < 2U * UNIT;
        CHECK_EQ(both & ~(torn ? before[k] & ~(unsigned)wanted[k] : 0U), 0);
        changing += both != 0U;
    }
    CHECK(changing > 0U);
    CHECK_EQ(write_some(), HAL_OK);
    for (int i = 0; i < 50; i++) {
        CHECK_EQ(hal_flash_read(&flash.hal, 0, now, SIZE), HAL_OK);
        CHECK(memcmp(now, wanted, SIZE) == 0);
    }
    new_flash(7);
    fake_flash_cut_at(&flash, 1, FAKE_FLASH_CUT_TORN);
    CHECK_EQ(write_some(), HAL_ERROR_GONE);
    fake_flash_power_on(&flash);
    CHECK_EQ(hal_flash_erase(&flash.hal, 0), HAL_OK);
    CHECK_EQ(hal_flash_poll(&flash.hal), HAL_OK);
    for (int i = 0; i < 50; i++) { // and so does erasing
        CHECK_EQ(hal_flash_read(&flash.hal, 0, now, SECTOR), HAL_OK);
        for (uint32_t k = 0; k < SECTOR; k++) {
            CHECK_EQ(now[k], HAL_FLASH_ERASED);
        }
    }
}

static void bits_rot(void) {
    new_flash(1);
    for (uint32_t address = 0; address < SIZE; address++) {
        for (uint32_t bit = 0; bit < 8U; bit++) {
            fake_flash_flip(&flash, address, bit);
            CHECK_EQ(memory[address], before[address] ^ 1U << bit);
            fake_flash_flip(&flash, address, bit);
            CHECK_EQ(memory[address], before[address]);
        }
    }
}

/// A fake set up wrongly must not run on and make tests pass.
static void needs_a_seed(void) {
    int status = 0;
    const pid_t child = fork();
    if (child == 0) {
        new_flash(0);
        _exit(0);
    }
    CHECK(child > 0 && waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT);
}

int main(void) {
    TEST(cut_at_every_operation);
    TEST(cut_while_busy);
    TEST(fails_in_part);
    TEST(tears_differ);
    TEST(torn_bits_are_unstable);
    TEST(bits_rot);
    TEST(needs_a_seed);
    return check_finish();
}

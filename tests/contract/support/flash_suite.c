#include "contract/support/flash_suite.h"

#include "contract/support/contract.h"

#define PATIENCE 30000

static const struct flash_fixture *fixture;
static uint64_t seed;
static uint8_t shadow[FLASH_SUITE_BYTES_MAX], scratch[FLASH_SUITE_BYTES_MAX];
static uint32_t size_bytes, sector_bytes, unit_bytes;

/// Waits for the end of the operation under way.
static enum hal_status finish(void) {
    enum hal_status status = HAL_BUSY;
    for (int i = 0; i < PATIENCE && status == HAL_BUSY; i++) {
        status = hal_flash_poll(fixture->flash);
        if (status == HAL_BUSY) {
            fixture->settle(fixture->context);
        }
    }
    return status;
}

static void erase(uint32_t sector) {
    CHECK_EQ(hal_flash_erase(fixture->flash, sector), HAL_OK);
    CHECK_EQ(finish(), HAL_OK);
    memset(shadow + sector * sector_bytes, HAL_FLASH_ERASED, sector_bytes);
}

static void program(uint32_t address, const uint8_t *data, uint32_t count) {
    CHECK_EQ(hal_flash_program(fixture->flash, address, data, count), HAL_OK);
    CHECK_EQ(finish(), HAL_OK);
    memcpy(shadow + address, data, count);
}

static void erase_all(void) {
    fixture->reset(fixture->context);
    for (uint32_t sector = 0; sector < fixture->geometry.sector_count; sector++) {
        erase(sector);
    }
}

static void expect_shadow(void) {
    memset(scratch, 0, size_bytes);
    CHECK_EQ(hal_flash_read(fixture->flash, 0, scratch, size_bytes), HAL_OK);
    CHECK(memcmp(scratch, shadow, size_bytes) == 0);
}

static uint32_t random_below(uint32_t limit) {
    return (uint32_t)(check_random(&seed) >> 32) % limit;
}

/// Random bytes, of which a flash that is not erased can take each bit.
static void random_bytes(uint8_t *data, uint32_t address, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        data[i] = (uint8_t)(check_random(&seed) >> 32) & shadow[address + i];
    }
}

static void every_op(void) {
    CONTRACT_EVERY_OP(flash, fixture->flash);
}

static void geometry_is_sound(void) {
    struct hal_flash_geometry got = {0};
    CHECK_EQ(hal_flash_geometry(fixture->flash, &got), HAL_OK);
    CHECK_EQ(got.sector_count, fixture->geometry.sector_count);
    CHECK_EQ(got.sector_bytes, fixture->geometry.sector_bytes);
    CHECK_EQ(got.unit_bytes, fixture->geometry.unit_bytes);
    CHECK(got.sector_count >= 2U && got.unit_bytes >= 1U);
    CHECK_EQ(got.unit_bytes & (got.unit_bytes - 1U), 0);
    CHECK_EQ(got.sector_bytes % got.unit_bytes, 0);
}

/// None of these may change a byte.
static void arguments(void) {
    erase_all();
    memset(scratch, 0, size_bytes);
    struct {
        uint32_t address, count;
    } const beyond[] = {{size_bytes, unit_bytes},      {size_bytes - unit_bytes, 2U * unit_bytes},
                        {0, size_bytes + unit_bytes},  {unit_bytes, 0U - unit_bytes},
                        {0U - unit_bytes, unit_bytes}, {0x80000000U, unit_bytes}};
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        CHECK_EQ(hal_flash_program(fixture->flash, beyond[i].address, scratch, beyond[i].count),
                 HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_flash_read(fixture->flash, beyond[i].address, scratch, beyond[i].count),
                 HAL_ERROR_ARGUMENT);
    }
    for (uint32_t off = 1; off < unit_bytes; off++) {
        CHECK_EQ(hal_flash_program(fixture->flash, off, scratch, unit_bytes), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_flash_program(fixture->flash, 0, scratch, off), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_flash_program(fixture->flash, 0, scratch, unit_bytes + off),
                 HAL_ERROR_ARGUMENT);
    }
    const uint32_t no_sector[] = {fixture->geometry.sector_count, 0x80000000U, UINT32_MAX};
    for (size_t i = 0; i < 3U; i++) {
        CHECK_EQ(hal_flash_erase(fixture->flash, no_sector[i]), HAL_ERROR_ARGUMENT);
    }
    CHECK_EQ(hal_flash_program(fixture->flash, 0, NULL, unit_bytes), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_flash_program(fixture->flash, 0, scratch, 0), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_flash_read(fixture->flash, 0, NULL, 1), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_flash_read(fixture->flash, 0, scratch, 0), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_flash_geometry(fixture->flash, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(finish(), HAL_OK);
    expect_shadow();
}

/// First and last unit, across a border of sectors, a whole sector; each byte of it and no other.
static void programs_what_it_is_given(void) {
    erase_all();
    const struct {
        uint32_t address, count;
    } places[] = {{0, unit_bytes},
                  {size_bytes - unit_bytes, unit_bytes},
                  {sector_bytes - unit_bytes, 2U * unit_bytes},
                  {sector_bytes / 2U / unit_bytes * unit_bytes, unit_bytes}};
    static uint8_t data[FLASH_SUITE_BYTES_MAX];
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        random_bytes(data, places[i].address, places[i].count);
        program(places[i].address, data, places[i].count);
        expect_shadow();
    }
    erase(1);
    random_bytes(data, sector_bytes, sector_bytes);
    program(sector_bytes, data, sector_bytes);
    expect_shadow();
    for (uint32_t i = 0; i < 300U && check_clean(); i++) { // a read of any piece is that piece
        const uint32_t address = random_below(size_bytes);
        const uint32_t count = 1U + random_below(size_bytes - address);
        CHECK_EQ(hal_flash_read(fixture->flash, address, scratch, count), HAL_OK);
        CHECK(memcmp(scratch, shadow + address, count) == 0);
    }
}

static void erases_its_sector_only(void) {
    for (uint32_t sector = 0; sector < fixture->geometry.sector_count && sector < 4U; sector++) {
        erase_all();
        static uint8_t data[FLASH_SUITE_BYTES_MAX];
        random_bytes(data, 0, size_bytes);
        program(0, data, size_bytes);
        erase(sector);
        expect_shadow();
        erase(sector);
        expect_shadow();
    }
}

/// Ones stay ones until they are cleared, zeros stay zeros until the sector is erased.
static void bits_only_fall(void) {
    erase_all();
    uint8_t data[256];
    for (unsigned bit = 0; bit < 8U; bit++) {
        memset(data, (int)(0xFFU << (bit + 1U) & 0xFFU), unit_bytes);
        program(0, data, unit_bytes);
        expect_shadow();
        for (uint32_t at = 0; at < unit_bytes && check_clean(); at++) {
            data[at] = (uint8_t)(data[at] | 1U << bit); // one bit would rise
            CHECK_EQ(hal_flash_program(fixture->flash, 0, data, unit_bytes), HAL_ERROR_ARGUMENT);
            data[at] = (uint8_t)(data[at] & ~(1U << bit));
        }
        expect_shadow();
    }
    memset(data, HAL_FLASH_ERASED, unit_bytes);
    CHECK_EQ(hal_flash_program(fixture->flash, 0, data, unit_bytes), HAL_ERROR_ARGUMENT);
    program(unit_bytes, data, unit_bytes); // all ones on erased bytes is allowed
    expect_shadow();
}

/// While an operation is under way all others wait.
static void one_operation_at_a_time(void) {
    erase_all();
    uint8_t data[256] = {0};
    CHECK_EQ(hal_flash_program(fixture->flash, 0, data, unit_bytes), HAL_OK);
    memset(shadow, 0, unit_bytes);
    if (hal_flash_poll(fixture->flash) == HAL_BUSY) {
        // It may end between any two of these calls.
        enum hal_status status = hal_flash_read(fixture->flash, 0, scratch, 1);
        CHECK(status == HAL_BUSY || status == HAL_OK);
        status = hal_flash_erase(fixture->flash, 1);
        CHECK(status == HAL_BUSY || status == HAL_OK);
        status = hal_flash_program(fixture->flash, unit_bytes, data, unit_bytes);
        CHECK(status == HAL_BUSY || status == HAL_OK);
        if (status == HAL_OK) {
            memset(shadow + unit_bytes, 0, unit_bytes);
        }
    }
    CHECK_EQ(finish(), HAL_OK);
    CHECK_EQ(hal_flash_poll(fixture->flash), HAL_OK);
    expect_shadow();
}

/// Hundreds of random operations beside a plain array.
static void behaves_like_an_array(void) {
    erase_all();
    static uint8_t data[FLASH_SUITE_BYTES_MAX];
    for (uint32_t i = 0; i < 150U && check_clean(); i++) {
        if (random_below(4) == 0U) {
            erase(random_below(fixture->geometry.sector_count));
        } else {
            const uint32_t unit = random_below(size_bytes / unit_bytes);
            const uint32_t room = size_bytes / unit_bytes - unit;
            const uint32_t count = 1U + random_below(room < 40U ? room : 40U);
            random_bytes(data, unit * unit_bytes, count * unit_bytes);
            program(unit * unit_bytes, data, count * unit_bytes);
        }
        if (fixture->reopen != NULL && random_below(16) == 0U) {
            fixture->reopen(fixture->context);
        }
        expect_shadow();
    }
}

static void keeps_its_contents(void) {
    erase_all();
    uint8_t data[256];
    random_bytes(data, unit_bytes, unit_bytes);
    program(unit_bytes, data, unit_bytes);
    for (int i = 0; i < 3; i++) {
        fixture->reopen(fixture->context);
        CHECK_EQ(finish(), HAL_OK); // nothing is under way
        expect_shadow();
    }
}

/// The end of an operation, in an exercise: true if it went well.
static bool finish_exercise(struct contract_plan *plan) {
    enum hal_status status = HAL_BUSY;
    for (int i = 0; i < PATIENCE && status == HAL_BUSY; i++) {
        status = hal_flash_poll(fixture->flash);
        fixture->settle(fixture->context);
    }
    return !contract_failed(plan, status);
}

static void read_exercise(struct contract_plan *plan) {
    CONTRACT_DO(plan, hal_flash_read(fixture->flash, 0, scratch, size_bytes));
}

/// A failed operation may have done its work in part, but nothing else.
static void exercise(struct contract_plan *plan) {
    static uint8_t data[FLASH_SUITE_BYTES_MAX];
    read_exercise(plan);
    memcpy(shadow, scratch, size_bytes);
    for (uint32_t round = 0; round < 2U; round++) {
        bool done = false;
        for (int tries = 0; tries < 2 && !done; tries++) {
            done = !contract_failed(plan, hal_flash_erase(fixture->flash, round)) &&
                   finish_exercise(plan);
            read_exercise(plan);
            for (uint32_t i = 0; i < size_bytes && check_clean(); i++) {
                CHECK(i / sector_bytes == round || scratch[i] == shadow[i]);
            }
        }
        memset(shadow + round * sector_bytes, HAL_FLASH_ERASED, sector_bytes);
        CHECK(done && memcmp(scratch, shadow, size_bytes) == 0);
        const uint32_t from = round * sector_bytes + unit_bytes, count = 3U * unit_bytes;
        random_bytes(data, from, count);
        done = false;
        for (int tries = 0; tries < 2 && !done; tries++) {
            done = !contract_failed(plan, hal_flash_program(fixture->flash, from, data, count)) &&
                   finish_exercise(plan);
            read_exercise(plan);
            for (uint32_t i = 0; i < size_bytes && check_clean(); i++) {
                const bool ours = i >= from && i < from + count;
                const unsigned least = ours ? data[i - from] : shadow[i];
                CHECK((scratch[i] & least) == least && (scratch[i] | shadow[i]) == shadow[i]);
            }
        }
        memcpy(shadow + from, data, count);
        CHECK(done && memcmp(scratch, shadow, size_bytes) == 0);
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void flash_suite(const struct flash_fixture *with) {
    fixture = with;
    seed = UINT64_C(0xA0761D6478BD642F);
    sector_bytes = with->geometry.sector_bytes;
    unit_bytes = with->geometry.unit_bytes;
    size_bytes = with->geometry.sector_count * sector_bytes;
    const bool fits = size_bytes <= FLASH_SUITE_BYTES_MAX && unit_bytes <= 256U;
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, geometry_is_sound);
    CONTRACT_IF(fits, "too large for the suite", with->name, arguments);
    CONTRACT_IF(fits, "too large for the suite", with->name, programs_what_it_is_given);
    CONTRACT_IF(fits, "too large for the suite", with->name, erases_its_sector_only);
    CONTRACT_IF(fits, "too large for the suite", with->name, bits_only_fall);
    CONTRACT_IF(fits, "too large for the suite", with->name, one_operation_at_a_time);
    CONTRACT_IF(fits, "too large for the suite", with->name, behaves_like_an_array);
    CONTRACT_IF(fits && with->reopen, "the rig can't switch it off", with->name,
                keeps_its_contents);
    CONTRACT_IF(fits && with->fail_at, "the rig can't make calls fail", with->name,
                fails_at_every_call);
}

/// NOR flash in memory that loses its power at any operation, and whose bits rot.
///
/// An operation is one unit programmed or one sector erased. What a call begins is done by poll:
/// busy_polls times it answers HAL_BUSY, then all the work is done, operation by operation. A poll
/// that fails to order (failures; calls that answer HAL_BUSY do not count) leaves the work done in
/// part: some operations done, one torn.
#ifndef DEVICES_FAKE_FLASH_H
#define DEVICES_FAKE_FLASH_H

#include "devices/fake_failures.h"
#include "hal/flash.h"

#define FAKE_FLASH_UNIT_BYTES_MAX 256U

enum fake_flash_cut {
    /// The operation is not begun.
    FAKE_FLASH_CUT_BEFORE,
    /// Program: each bit that was to fall has fallen or not, and may read differently each time
    /// until it is programmed or erased. Erase: each byte is as it was, erased, or anything.
    FAKE_FLASH_CUT_TORN,
    /// It is done, and nobody learns of it.
    FAKE_FLASH_CUT_AFTER
};

enum fake_flash_work { FAKE_FLASH_IDLE, FAKE_FLASH_PROGRAMMING, FAKE_FLASH_ERASING };

struct fake_flash {
    struct hal_flash hal;
    struct fake_failures failures;
    struct hal_flash_geometry geometry;
    uint8_t *memory;
    /// 0 at first; the caller's to set.
    uint32_t busy_polls;
    /// Operations so far, those that the power cut kept from being done included. Wraps.
    uint32_t operation_count;
    /// Sectors erased so far: wear. Wraps.
    uint32_t erase_count;
    bool is_off;

    // Private from here on.
    uint32_t cut_after_count;
    enum fake_flash_cut cut;
    uint64_t random_state;
    enum fake_flash_work work;
    const uint8_t *data;
    uint32_t address, size_bytes, polls_left;
    enum hal_status last_status;
    uint32_t unstable_address;
    uint8_t unstable_bits[FAKE_FLASH_UNIT_BYTES_MAX];
};

/// Must not move in memory afterwards. memory: sector_count * sector_bytes, as they are: a test
/// makes them HAL_FLASH_ERASED or what a board had. unit_bytes at most FAKE_FLASH_UNIT_BYTES_MAX.
/// seed: for torn bits, not 0.
void fake_flash_init(struct fake_flash *flash, const struct hal_flash_geometry *geometry,
                     uint8_t *memory, uint64_t seed);

/// The power fails at the nth operation from now (1: the next): before, during or after it. From
/// then on every call says HAL_ERROR_GONE. nth 0: it doesn't.
void fake_flash_cut_at(struct fake_flash *flash, uint32_t nth, enum fake_flash_cut cut);
/// The power is back (or is cut and comes back now): nothing is under way, the contents are what
/// they were.
void fake_flash_power_on(struct fake_flash *flash);
/// Turns one bit over. bit: 0 to 7.
void fake_flash_flip(struct fake_flash *flash, uint32_t address, uint32_t bit);

#endif

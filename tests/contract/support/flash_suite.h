/// The contract of hal/flash.h as a test.
#ifndef CONTRACT_SUPPORT_FLASH_SUITE_H
#define CONTRACT_SUPPORT_FLASH_SUITE_H

#include "hal/flash.h"

/// The largest flash that the suite can test.
#define FLASH_SUITE_BYTES_MAX 65536U

struct flash_fixture {
    const char *name;
    const struct hal_flash *flash;
    /// At least two sectors. The suite leaves it erased or not.
    struct hal_flash_geometry geometry;
    void *context;
    /// No failure pending, nothing under way. The contents stay.
    void (*reset)(void *context);
    /// A moment of real or virtual time.
    void (*settle)(void *context);
    /// Power off and on, or the file closed and opened again.
    void (*reopen)(void *context);
    /// See contract.h. Calls that answer HAL_BUSY do not count. A poll that fails means that the
    /// operation has failed.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
};

/// Needs reset and settle.
void flash_suite(const struct flash_fixture *fixture);

#endif

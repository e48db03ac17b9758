/// NOR flash for settings: a region of equal sectors that a board sets aside, or a file on Linux.
///
/// Erasing makes every bit of a sector 1; programming only turns 1 into 0. Both begin and then run
/// in the background, one at a time. Call poll until it says that they are done: an implementation
/// may do the work there.
///
/// If the power fails or the operation fails on its way, the other sectors are as they were, and
/// - program: of the bytes of this operation, each bit that was to become 0 may be either, or even
///   read differently each time. The units are programmed in ascending order.
/// - erase: each bit of the sector may be either.
/// Shown: tests/contract/support/flash_suite.h, on every implementation; power that fails:
/// tests/contract/fake_flash.c.
#ifndef HAL_FLASH_H
#define HAL_FLASH_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define HAL_FLASH_ERASED 0xFFU

/// size_bytes = sector_count * sector_bytes < 2^31. unit_bytes: programming starts and ends at
/// multiples of it; a power of two that divides sector_bytes.
struct hal_flash_geometry {
    uint32_t sector_count, sector_bytes, unit_bytes;
};

struct hal_flash_ops {
    enum hal_status (*geometry)(void *ctx, struct hal_flash_geometry *geometry);
    enum hal_status (*read)(void *ctx, uint32_t address, uint8_t *data, uint32_t size_bytes);
    enum hal_status (*program)(void *ctx, uint32_t address, const uint8_t *data,
                               uint32_t size_bytes);
    enum hal_status (*erase)(void *ctx, uint32_t sector);
    enum hal_status (*poll)(void *ctx);
};

struct hal_flash {
    const struct hal_flash_ops *ops;
    void *ctx;
};

/// Fills *flash. HAL_ERROR_ARGUMENT (and *flash as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status
hal_flash_bind(struct hal_flash *flash, const struct hal_flash_ops *ops, void *ctx) {
    if (flash == NULL || ops == NULL || ops->geometry == NULL || ops->read == NULL ||
        ops->program == NULL || ops->erase == NULL || ops->poll == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *flash = (struct hal_flash){ops, ctx};
    return HAL_OK;
}

/// Returns:  HAL_OK; HAL_ERROR_GONE: *geometry is not set.
/// Cost:     a copy.
MUST_CHECK static inline enum hal_status hal_flash_geometry(const struct hal_flash *flash,
                                                            struct hal_flash_geometry *geometry) {
    if (geometry == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return flash->ops->geometry(flash->ctx, geometry);
}

/// Reads size_bytes (at least 1) from any address.
/// Returns:  HAL_OK; HAL_BUSY: an operation is under way;
///           HAL_ERROR_ARGUMENT: beyond the end; HAL_ERROR_IO, HAL_ERROR_GONE: data is undefined.
/// Cost:     a copy; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_flash_read(const struct hal_flash *flash,
                                                        uint32_t address, uint8_t *data,
                                                        uint32_t size_bytes) {
    if (data == NULL || size_bytes == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    return flash->ops->read(flash->ctx, address, data, size_bytes);
}

/// Begins to program. data stays as it is until poll no longer says HAL_BUSY.
/// Returns:  HAL_OK: begun, see poll; HAL_BUSY: another operation is under way;
///           HAL_ERROR_ARGUMENT: beyond the end, address or size_bytes no multiple of a unit, or a
///           bit would have to turn from 0 to 1. Nothing was begun;
///           HAL_ERROR_IO, HAL_ERROR_GONE: may be done in part.
/// Cost:     STM32F4 16 to 100 us for each 4 bytes, RP2040 0.4 to 3 ms for each 256 bytes, and
///           the processor halted if it runs from the same flash: at boot or at standstill only. On
///           Linux a few system calls; the disk is waited for in the background.
MUST_CHECK static inline enum hal_status hal_flash_program(const struct hal_flash *flash,
                                                           uint32_t address, const uint8_t *data,
                                                           uint32_t size_bytes) {
    if (data == NULL || size_bytes == 0U) {
        return HAL_ERROR_ARGUMENT;
    }
    return flash->ops->program(flash->ctx, address, data, size_bytes);
}

/// Begins to erase a sector.
/// Returns:  as hal_flash_program; HAL_ERROR_ARGUMENT: no such sector.
/// Cost:     STM32F4 0.25 to 0.5 s for 16 KiB, RP2040 45 to 400 ms for 4 KiB; else as
/// hal_flash_program.
MUST_CHECK static inline enum hal_status hal_flash_erase(const struct hal_flash *flash,
                                                         uint32_t sector) {
    return flash->ops->erase(flash->ctx, sector);
}

/// How the operation begun last is doing.
/// Returns:  HAL_BUSY: under way; HAL_OK: done, durable; or there was none yet;
///           HAL_ERROR_IO: it failed, and may be done in part; said until the next one begins. Read
///           back, erase and try again, or use another sector; HAL_ERROR_GONE.
/// Cost:     a register read, or a bounded piece of the work.
MUST_CHECK static inline enum hal_status hal_flash_poll(const struct hal_flash *flash) {
    return flash->ops->poll(flash->ctx);
}

/// Whether a geometry is one that this header allows. For implementations.
static inline bool hal_flash_is_sound(const struct hal_flash_geometry *geometry) {
    const uint32_t unit = geometry->unit_bytes;
    return unit != 0U && (unit & (unit - 1U)) == 0U && geometry->sector_bytes != 0U &&
           (geometry->sector_bytes & (unit - 1U)) == 0U && geometry->sector_count != 0U &&
           (uint64_t)geometry->sector_count * geometry->sector_bytes < UINT64_C(0x80000000);
}

/// Whether size_bytes from address lie inside. For implementations.
static inline bool hal_flash_has(const struct hal_flash_geometry *geometry, uint32_t address,
                                 uint32_t size_bytes) {
    const uint32_t end = geometry->sector_count * geometry->sector_bytes;
    return address < end && size_bytes <= end - address;
}

/// Whether they start and end at units. For implementations.
static inline bool hal_flash_is_aligned(const struct hal_flash_geometry *geometry, uint32_t address,
                                        uint32_t size_bytes) {
    return ((address | size_bytes) & (geometry->unit_bytes - 1U)) == 0U;
}

#endif

#include "devices/fake_flash.h"

#include "devices/fake_bind.h"

#include <string.h>

#define NO_ADDRESS UINT32_MAX

/// xorshift64: the same bits on every machine.
static uint8_t random_byte(struct fake_flash *flash) {
    uint64_t x = flash->random_state;
    x ^= x << 13;
    x ^= x >> 7;
    x ^= x << 17;
    flash->random_state = x;
    return (uint8_t)(x >> 32);
}

static enum hal_status fake_flash_geometry(void *ctx, struct hal_flash_geometry *geometry) {
    const struct fake_flash *flash = ctx;
    if (flash->is_off) {
        return HAL_ERROR_GONE;
    }
    const enum hal_status status = fake_failures_presence(&flash->failures);
    if (status == HAL_OK) {
        *geometry = flash->geometry;
    }
    return status;
}

/// What any call that works on the memory must pass first.
static enum hal_status admit(struct fake_flash *flash) {
    if (flash->is_off) {
        return HAL_ERROR_GONE;
    }
    if (flash->work != FAKE_FLASH_IDLE) {
        return flash->failures.gone ? HAL_ERROR_GONE : HAL_BUSY;
    }
    return fake_failures_call(&flash->failures);
}

static enum hal_status fake_flash_read(void *ctx, uint32_t address, uint8_t *data,
                                       uint32_t size_bytes) {
    struct fake_flash *flash = ctx;
    if (!hal_flash_has(&flash->geometry, address, size_bytes)) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = admit(flash);
    if (status != HAL_OK) {
        return status;
    }
    memcpy(data, flash->memory + address, size_bytes);
    for (uint32_t i = 0; i < size_bytes && flash->unstable_address != NO_ADDRESS; i++) {
        const uint32_t at = address + i - flash->unstable_address;
        if (at < flash->geometry.unit_bytes) {
            data[i] = (uint8_t)(data[i] ^ (flash->unstable_bits[at] & random_byte(flash)));
        }
    }
    return HAL_OK;
}

static void begin(struct fake_flash *flash, enum fake_flash_work work) {
    flash->work = work;
    flash->polls_left = flash->busy_polls;
}

static enum hal_status fake_flash_program(void *ctx, uint32_t address, const uint8_t *data,
                                          uint32_t size_bytes) {
    struct fake_flash *flash = ctx;
    if (!hal_flash_has(&flash->geometry, address, size_bytes) ||
        !hal_flash_is_aligned(&flash->geometry, address, size_bytes)) {
        return HAL_ERROR_ARGUMENT;
    }
    if (flash->work == FAKE_FLASH_IDLE && !flash->is_off) {
        for (uint32_t i = 0; i < size_bytes; i++) {
            if ((data[i] & ~(unsigned)flash->memory[address + i]) != 0U) {
                return HAL_ERROR_ARGUMENT;
            }
        }
    }
    const enum hal_status status = admit(flash);
    if (status == HAL_OK) {
        flash->address = address;
        flash->data = data;
        flash->size_bytes = size_bytes;
        begin(flash, FAKE_FLASH_PROGRAMMING);
    }
    return status;
}

static enum hal_status fake_flash_erase(void *ctx, uint32_t sector) {
    struct fake_flash *flash = ctx;
    if (sector >= flash->geometry.sector_count) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = admit(flash);
    if (status == HAL_OK) {
        flash->address = sector * flash->geometry.sector_bytes;
        begin(flash, FAKE_FLASH_ERASING);
    }
    return status;
}

/// Programs the unit at address with what is due there.
static void program_unit(struct fake_flash *flash, uint32_t address, bool torn) {
    const uint8_t *data = flash->data + (address - flash->address);
    if (!torn && flash->unstable_address == address) {
        for (uint32_t i = 0; i < flash->geometry.unit_bytes; i++) {
            flash->unstable_bits[i] &= data[i]; // the bits that fall now are settled
        }
    }
    for (uint32_t i = 0; i < flash->geometry.unit_bytes; i++) {
        uint8_t *cell = &flash->memory[address + i];
        if (torn) {
            const uint8_t falling = (uint8_t)(*cell & ~(unsigned)data[i]);
            flash->unstable_bits[i] = (uint8_t)(falling & random_byte(flash));
            *cell = (uint8_t)(*cell & ~(unsigned)(falling & random_byte(flash)));
        } else {
            *cell &= data[i];
        }
    }
    if (torn) {
        flash->unstable_address = address;
    }
}

static void erase_sector(struct fake_flash *flash, uint32_t address, bool torn) {
    if (flash->unstable_address - address < flash->geometry.sector_bytes) {
        flash->unstable_address = NO_ADDRESS;
    }
    for (uint32_t i = 0; i < flash->geometry.sector_bytes; i++) {
        uint8_t *cell = &flash->memory[address + i];
        switch (torn ? random_byte(flash) % 3U : 0U) {
        case 0:
            *cell = HAL_FLASH_ERASED;
            break;
        case 1:
            *cell = random_byte(flash);
            break;
        default:
            break;
        }
    }
    flash->erase_count++;
}

static void operate(struct fake_flash *flash, uint32_t address, bool torn) {
    if (flash->work == FAKE_FLASH_ERASING) {
        erase_sector(flash, address, torn);
    } else {
        program_unit(flash, address, torn);
    }
}

/// Does the work, up to its end or that of the power. limit: so many operations, then one torn.
static void work_off(struct fake_flash *flash, uint32_t limit) {
    const bool erasing = flash->work == FAKE_FLASH_ERASING;
    const uint32_t count = erasing ? 1U : flash->size_bytes / flash->geometry.unit_bytes;
    for (uint32_t i = 0; i < count && i <= limit && !flash->is_off; i++) {
        const uint32_t address = flash->address + i * flash->geometry.unit_bytes;
        flash->operation_count++;
        if (flash->cut_after_count > 0U && --flash->cut_after_count == 0U) {
            flash->is_off = true;
            if (flash->cut != FAKE_FLASH_CUT_BEFORE) {
                operate(flash, address, flash->cut == FAKE_FLASH_CUT_TORN);
            }
        } else {
            operate(flash, address, i == limit);
        }
    }
    flash->work = FAKE_FLASH_IDLE;
}

static enum hal_status fake_flash_poll(void *ctx) {
    struct fake_flash *flash = ctx;
    if (flash->is_off) {
        return HAL_ERROR_GONE;
    }
    if (flash->work != FAKE_FLASH_IDLE && flash->polls_left > 0U && !flash->failures.gone) {
        flash->polls_left--;
        return HAL_BUSY;
    }
    const enum hal_status order = fake_failures_call(&flash->failures);
    if (flash->work == FAKE_FLASH_IDLE) {
        return order == HAL_OK ? flash->last_status : order;
    }
    const uint32_t units = flash->size_bytes / flash->geometry.unit_bytes;
    const bool erasing = flash->work == FAKE_FLASH_ERASING;
    work_off(flash, order == HAL_OK ? UINT32_MAX : (erasing ? 0U : random_byte(flash) % units));
    flash->last_status = flash->is_off ? HAL_ERROR_GONE : order;
    return flash->last_status;
}

static const struct hal_flash_ops ops = {fake_flash_geometry, fake_flash_read, fake_flash_program,
                                         fake_flash_erase, fake_flash_poll};

void fake_flash_init(struct fake_flash *flash, const struct hal_flash_geometry *geometry,
                     uint8_t *memory, uint64_t seed) {
    *flash = (struct fake_flash){.geometry = *geometry,
                                 .memory = memory,
                                 .random_state = seed,
                                 .unstable_address = NO_ADDRESS};
    if (!hal_flash_is_sound(geometry) || geometry->unit_bytes > FAKE_FLASH_UNIT_BYTES_MAX ||
        seed == 0U) {
        abort();
    }
    fake_bind_check(hal_flash_bind(&flash->hal, &ops, flash));
}

void fake_flash_cut_at(struct fake_flash *flash, uint32_t nth, enum fake_flash_cut cut) {
    flash->cut_after_count = nth;
    flash->cut = cut;
}

void fake_flash_power_on(struct fake_flash *flash) {
    flash->is_off = false;
    flash->work = FAKE_FLASH_IDLE;
    flash->last_status = HAL_OK;
}

void fake_flash_flip(struct fake_flash *flash, uint32_t address, uint32_t bit) {
    flash->memory[address] = (uint8_t)(flash->memory[address] ^ 1U << bit);
}

/// The flash interface: wait states, caches, and the locks of the control registers.
///
/// Source: RM0090, chapter 3 (F405/407). Left out: programming and erasing (CR.PG, SER, MER and
/// STRT complain); the image is in the flash from the start. Shown: tests/mcu/system_parts.c.
#ifndef MCU_FLASH_INTERFACE_H
#define MCU_FLASH_INTERFACE_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

struct flash_interface {
    struct soc *soc;
    uint32_t acr, sr, cr, optcr;
    uint8_t keys, option_keys; ///< how many of the two keys have come
    bool jammed;               ///< a wrong key locks CR until reset
};

void flash_interface_reset(struct flash_interface *flash, struct soc *soc);
uint32_t flash_interface_read(void *model, uint32_t offset);
void flash_interface_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// Wait states.
uint32_t flash_interface_latency(const struct flash_interface *flash);

#endif

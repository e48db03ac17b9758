#include "mcu/flash_interface.h"

#include "mcu/soc.h"

#define ACR_BITS    0x1F07U
#define ACR_LATENCY 7U
#define SR_FLAGS    0xF3U
#define CR_LOCK     (UINT32_C(1) << 31)
#define CR_BITS     0x0300037FU
#define CR_WORKS    0x00010007U // PG, SER, MER, STRT
#define OPTCR_LOCK  1U
#define OPTCR_RESET 0x0FFFAAEDU
#define KEY1        0x45670123U
#define KEY2        0xCDEF89ABU
#define OPTION_KEY1 0x08192A3BU
#define OPTION_KEY2 0x4C5D6E7FU

void flash_interface_reset(struct flash_interface *flash, struct soc *soc) {
    *flash = (struct flash_interface){.soc = soc, .cr = CR_LOCK, .optcr = OPTCR_RESET};
}

uint32_t flash_interface_latency(const struct flash_interface *flash) {
    return flash->acr & ACR_LATENCY;
}

uint32_t flash_interface_read(void *model, uint32_t offset) {
    const struct flash_interface *flash = model;
    switch (offset) {
    case 0x00:
        return flash->acr;
    case 0x0C:
        return flash->sr;
    case 0x10:
        return flash->cr;
    case 0x14:
        return flash->optcr;
    default:
        return 0; // the key registers can only be written
    }
}

/// One more key. Returns: whether the lock opens. A wrong one starts over.
static bool take_key(uint8_t *keys, uint32_t value, uint32_t first, uint32_t second) {
    const bool right = value == (*keys == 0U ? first : second);
    *keys = right ? (uint8_t)(*keys + 1U) : 0U;
    return *keys == 2U;
}

static void write_key(struct flash_interface *flash, uint32_t value) {
    const uint8_t before = flash->keys;
    if (flash->jammed || (flash->cr & CR_LOCK) == 0U) {
        return;
    }
    if (take_key(&flash->keys, value, KEY1, KEY2)) {
        flash->keys = 0;
        flash->cr &= ~CR_LOCK;
    } else if (flash->keys <= before) {
        flash->jammed = true;
        soc_complain(flash->soc, "a wrong key 0x%08X locks the flash until reset", value);
    }
}

static void write_cr(struct flash_interface *flash, uint32_t value) {
    if ((flash->cr & CR_LOCK) != 0U) {
        return;
    }
    if ((value & CR_WORKS) != 0U) {
        soc_complain(flash->soc, "programming and erasing the flash has no model");
    }
    flash->cr = value & (CR_BITS | CR_LOCK) & ~CR_WORKS;
}

void flash_interface_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct flash_interface *flash = model;
    (void)lanes;
    switch (offset) {
    case 0x00:
        flash->acr = value & ACR_BITS;
        rcc_check_limits(&flash->soc->rcc);
        break;
    case 0x04:
        write_key(flash, value);
        break;
    case 0x08:
        if (take_key(&flash->option_keys, value, OPTION_KEY1, OPTION_KEY2)) {
            flash->option_keys = 0;
            flash->optcr &= ~OPTCR_LOCK;
        }
        break;
    case 0x0C:
        flash->sr &= ~(value & SR_FLAGS);
        break;
    case 0x10:
        write_cr(flash, value);
        break;
    case 0x14:
        flash->optcr |= value & OPTCR_LOCK;
        break;
    default:
        break;
    }
}

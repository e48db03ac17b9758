/// Power control: the voltage scale and the lock of the backup domain.
///
/// Source: RM0090, chapter 5 (F405/407). Left out: low-power modes, the voltage detector (both
/// complain).
/// Shown: tests/mcu/system_parts.c.
#ifndef MCU_PWR_H
#define MCU_PWR_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

struct pwr {
    struct soc *soc;
    uint32_t cr, csr;
};

void pwr_reset(struct pwr *pwr, struct soc *soc);
uint32_t pwr_read(void *model, uint32_t offset);
void pwr_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// Scale 1 allows 168 MHz, scale 2 only 144.
bool pwr_scale_one(const struct pwr *pwr);
/// CR.DBP.
bool pwr_backup_writable(const struct pwr *pwr);

#endif

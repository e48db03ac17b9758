/// The processor's own timer.
///
/// Source: ARMv7-M Architecture Reference Manual, B3.3; PM0214, 4.5. It counts down with HCLK or an
/// eighth of it; from 1 to 0 it sets COUNTFLAG and makes the exception pending, one clock later it
/// starts again at LOAD. A write to VAL clears it and COUNTFLAG, and the next clock loads LOAD.
/// Shown: tests/mcu/systick.c.
#ifndef MCU_SYSTICK_H
#define MCU_SYSTICK_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

struct systick {
    struct soc *soc;
    uint32_t control; ///< ENABLE, TICKINT, CLKSOURCE
    uint32_t load;
    bool count_flag;
    // While it runs: VAL was `start` at start_cycle. While it stands: start is VAL.
    uint32_t start;
    uint64_t start_cycle;
};

void systick_reset(struct systick *systick, struct soc *soc);
void systick_due(struct systick *systick);

/// offset: from 0xE000E010.
uint32_t systick_read(struct systick *systick, uint32_t offset);
void systick_write(struct systick *systick, uint32_t offset, uint32_t value);

#endif

/// The independent watchdog.
///
/// Source: RM0090, chapter 21. It counts down with the low-speed internal oscillator (LSI) divided
/// by 4 to 256, and resets the chip at zero; nothing stops it but a reset. PR and RLR can be
/// written after the key 0x5555, and need five periods of the running LSI to cross over to it (PVU,
/// RVU); what is written meanwhile is lost. They count from the next reload on. Left out: start by
/// option byte, the freeze in debug mode. Shown: tests/mcu/iwdg.c.
#ifndef MCU_IWDG_H
#define MCU_IWDG_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

struct iwdg {
    struct soc *soc;
    uint32_t pr, rlr;               ///< as read
    uint32_t active_pr, active_rlr; ///< as counted with
    /// End of a crossing; 0: none; SOC_NEVER: the LSI does not run yet.
    uint64_t pr_until_ns, rlr_until_ns;
    bool unlocked, started;
    uint64_t expires_ns;
};

void iwdg_reset(struct iwdg *iwdg, struct soc *soc);
void iwdg_due(struct iwdg *iwdg);
uint32_t iwdg_read(void *model, uint32_t offset);
void iwdg_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// The LSI runs from now on: what was written before starts to cross over.
void iwdg_lsi_started(struct iwdg *iwdg);

bool iwdg_runs(const struct iwdg *iwdg);

#endif

#include "mcu/iwdg.h"

#include "mcu/soc.h"

#define KEY_UNLOCK   0x5555U
#define KEY_RELOAD   0xAAAAU
#define KEY_START    0xCCCCU
#define RELOAD_RESET 0xFFFU

/// How long a value takes to cross over to the clock of the counter.
#define UPDATE_LSI_PERIODS 5U

void iwdg_reset(struct iwdg *iwdg, struct soc *soc) {
    *iwdg = (struct iwdg){.soc = soc, .rlr = RELOAD_RESET, .active_rlr = RELOAD_RESET};
    soc_schedule(soc, SOC_IWDG, SOC_NEVER);
}

bool iwdg_runs(const struct iwdg *iwdg) {
    return iwdg->started;
}

static uint64_t lsi_ns(const struct iwdg *iwdg, uint64_t periods) {
    return periods * UINT64_C(1000000000) / iwdg->soc->options.lsi_hz;
}

/// One value on its way to the other clock, which must run for that.
static void cross(struct iwdg *iwdg, uint64_t *until_ns, uint32_t value, uint32_t *active) {
    const uint64_t now = soc_now_ns(iwdg->soc);
    if (*until_ns == SOC_NEVER && rcc_lsi_runs(&iwdg->soc->rcc)) {
        *until_ns = now + lsi_ns(iwdg, UPDATE_LSI_PERIODS);
    }
    if (*until_ns != 0U && *until_ns <= now) {
        *until_ns = 0;
        *active = value;
    }
}

/// Takes over what has crossed by now.
static void settle(struct iwdg *iwdg) {
    cross(iwdg, &iwdg->pr_until_ns, iwdg->pr, &iwdg->active_pr);
    cross(iwdg, &iwdg->rlr_until_ns, iwdg->rlr, &iwdg->active_rlr);
}

void iwdg_lsi_started(struct iwdg *iwdg) {
    settle(iwdg);
}

static void reload(struct iwdg *iwdg) {
    if (!iwdg->started) {
        return;
    }
    const uint64_t divider = UINT64_C(4) << (iwdg->active_pr < 6U ? iwdg->active_pr : 6U);
    iwdg->expires_ns =
        soc_now_ns(iwdg->soc) + lsi_ns(iwdg, divider * ((uint64_t)iwdg->active_rlr + 1U));
    soc_schedule_ns(iwdg->soc, SOC_IWDG, iwdg->expires_ns);
}

void iwdg_due(struct iwdg *iwdg) {
    settle(iwdg);
    if (iwdg->started && soc_now_ns(iwdg->soc) >= iwdg->expires_ns) {
        soc_want_reset(iwdg->soc, SOC_RESET_WATCHDOG);
    } else if (iwdg->started) {
        soc_schedule_ns(iwdg->soc, SOC_IWDG, iwdg->expires_ns);
    }
}

uint32_t iwdg_read(void *model, uint32_t offset) {
    struct iwdg *iwdg = model;
    settle(iwdg);
    switch (offset) {
    case 0x4:
        return iwdg->pr;
    case 0x8:
        return iwdg->rlr;
    case 0xC:
        return (iwdg->pr_until_ns != 0U ? 1U : 0U) | (iwdg->rlr_until_ns != 0U ? 2U : 0U);
    default:
        return 0;
    }
}

static void write_key(struct iwdg *iwdg, uint32_t key) {
    iwdg->unlocked = key == KEY_UNLOCK;
    if (key == KEY_START && !iwdg->started) {
        iwdg->started = true;
        rcc_force_lsi(&iwdg->soc->rcc);
        reload(iwdg);
    } else if (key == KEY_RELOAD) {
        reload(iwdg);
    }
}

void iwdg_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct iwdg *iwdg = model;
    (void)lanes;
    settle(iwdg);
    if (offset == 0U) {
        write_key(iwdg, value & 0xFFFFU);
        return;
    }
    if (!iwdg->unlocked) {
        return;
    }
    if (offset == 0x4U && iwdg->pr_until_ns == 0U) {
        iwdg->pr = value & 7U;
        iwdg->pr_until_ns = SOC_NEVER;
    } else if (offset == 0x8U && iwdg->rlr_until_ns == 0U) {
        iwdg->rlr = value & 0xFFFU;
        iwdg->rlr_until_ns = SOC_NEVER;
    }
    settle(iwdg);
}

#include "rp2040/rp2040_watchdog.h"

#include "rp2040/rp2040_registers.h"

/// Erratum RP2040-E1: the counter goes down by two each microsecond.
#define COUNTS_PER_US 2U

/// In a register that only power and the reset pin clear (4.7.6). Any number that isn't there by
/// chance; the ROM uses the registers from 4 on.
#define MARK      0xB0E51647U
#define MARK_SLOT 0U

static enum hal_status watchdog_start(void *ctx, uint32_t timeout_us) {
    struct rp2040_watchdog *watchdog = ctx;
    if (watchdog->started) {
        return HAL_ERROR_ARGUMENT;
    }
    if (timeout_us > RP2040_WATCHDOG_LOAD_MAX / COUNTS_PER_US) {
        return HAL_ERROR_UNSUPPORTED;
    }
    watchdog->load = timeout_us * COUNTS_PER_US;
    RP2040_PSM->watchdog_select = RP2040_PSM_BUT_OSCILLATORS;
    RP2040_WATCHDOG->control = 0;
    RP2040_WATCHDOG->load = watchdog->load;
    RP2040_WATCHDOG->control = RP2040_WATCHDOG_CONTROL_ENABLE | RP2040_WATCHDOG_CONTROL_PAUSE;
    watchdog->started = true;
    return HAL_OK;
}

static enum hal_status watchdog_feed(void *ctx) {
    const struct rp2040_watchdog *watchdog = ctx;
    if (!watchdog->started) {
        return HAL_ERROR_DOWN;
    }
    RP2040_WATCHDOG->load = watchdog->load;
    return HAL_OK;
}

static enum hal_status watchdog_reset_cause(void *ctx, enum hal_reset_cause *cause) {
    const struct rp2040_watchdog *watchdog = ctx;
    *cause = watchdog->cause;
    return HAL_OK;
}

static const struct hal_watchdog_ops rp2040_watchdog_ops = {watchdog_start, watchdog_feed,
                                                            watchdog_reset_cause};

/// The flags of power and pin stay until the next of these, so they come last. The ROM, too, starts
/// a new image by the watchdog.
static enum hal_reset_cause cause_of(uint32_t reason, uint32_t mark, uint32_t chip) {
    if (mark == MARK && (reason & RP2040_WATCHDOG_REASON_TIMER) != 0U) {
        return HAL_RESET_WATCHDOG;
    }
    if (mark == MARK || reason != 0U) {
        return HAL_RESET_SOFTWARE;
    }
    return (chip & RP2040_CHIP_RESET_POWER) != 0U     ? HAL_RESET_POWER_ON
           : (chip & RP2040_CHIP_RESET_RUN_PIN) != 0U ? HAL_RESET_PIN
                                                      : HAL_RESET_UNKNOWN;
}

void rp2040_watchdog_init(struct rp2040_watchdog *watchdog) {
    volatile uint32_t *mark = &RP2040_WATCHDOG->scratch[MARK_SLOT];
    *watchdog = (struct rp2040_watchdog){
        .hal = {&rp2040_watchdog_ops, watchdog},
        .cause = cause_of(RP2040_WATCHDOG->reason, *mark, RP2040_CHIP_RESET)};
    *mark = MARK;
}

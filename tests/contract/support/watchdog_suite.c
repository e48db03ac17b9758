#include "contract/support/watchdog_suite.h"

#include "contract/support/contract.h"

static const struct watchdog_fixture *fixture;

static void reset(void) {
    fixture->reset(fixture->context);
}

static void pass(uint32_t span_us) {
    fixture->pass(fixture->context, span_us);
}

static bool has_fired(void) {
    return fixture->has_fired(fixture->context);
}

static enum hal_reset_cause cause_now(void) {
    enum hal_reset_cause cause = HAL_RESET_UNKNOWN;
    CHECK_EQ(hal_watchdog_reset_cause(fixture->watchdog, &cause), HAL_OK);
    return cause;
}

static void every_op(void) {
    CONTRACT_EVERY_OP(watchdog, fixture->watchdog);
}

static void arguments(void) {
    reset();
    CHECK_EQ(hal_watchdog_start(fixture->watchdog, 0), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_watchdog_reset_cause(fixture->watchdog, NULL), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_watchdog_feed(fixture->watchdog), HAL_ERROR_DOWN);
    const uint32_t impossible[] = {fixture->too_short_us, fixture->too_long_us};
    for (size_t i = 0; i < 2U; i++) {
        if (impossible[i] != 0U) {
            CHECK_EQ(hal_watchdog_start(fixture->watchdog, impossible[i]), HAL_ERROR_UNSUPPORTED);
        }
    }
    CHECK_EQ(hal_watchdog_feed(fixture->watchdog), HAL_ERROR_DOWN);
    pass(2U * fixture->timeout_us_max);
    CHECK(!has_fired()); // none of that started it
    CHECK_EQ(hal_watchdog_start(fixture->watchdog, fixture->timeout_us_min), HAL_OK);
    CHECK_EQ(hal_watchdog_start(fixture->watchdog, fixture->timeout_us_max), HAL_ERROR_ARGUMENT);
    pass(fixture->timeout_us_min + 1U);
    CHECK(has_fired()); // the second start did not make it slower
}

static void fed_in_time_it_rests(void) {
    reset();
    CHECK_EQ(hal_watchdog_start(fixture->watchdog, fixture->timeout_us_min), HAL_OK);
    for (int i = 0; i < 100 && check_clean(); i++) {
        pass(fixture->timeout_us_min / 4U);
        CHECK(!has_fired());
        CHECK_EQ(hal_watchdog_feed(fixture->watchdog), HAL_OK);
    }
}

/// Between half the time and all of it after the last feed, however many there were.
static void hungry_it_fires(void) {
    const uint32_t timeouts_us[] = {fixture->timeout_us_min, fixture->timeout_us_max};
    for (size_t i = 0; i < 2U; i++) {
        for (uint32_t feeds = 0; feeds < 3U; feeds++) {
            reset();
            CHECK_EQ(hal_watchdog_start(fixture->watchdog, timeouts_us[i]), HAL_OK);
            for (uint32_t k = 0; k < feeds; k++) {
                pass(timeouts_us[i] / 4U);
                CHECK_EQ(hal_watchdog_feed(fixture->watchdog), HAL_OK);
            }
            pass(timeouts_us[i] / 2U - 1U);
            CHECK(!has_fired());
            pass(timeouts_us[i] - timeouts_us[i] / 2U + 2U);
            CHECK(has_fired());
        }
    }
}

static void reset_cause_is_told(void) {
    reset();
    CHECK_EQ(cause_now(), HAL_RESET_POWER_ON);
    for (int i = 0; i < 2; i++) {
        CHECK_EQ(hal_watchdog_start(fixture->watchdog, fixture->timeout_us_min), HAL_OK);
        pass(fixture->timeout_us_min + 1U);
        CHECK(has_fired());
        fixture->come_up(fixture->context);
        CHECK(!has_fired());
        CHECK_EQ(cause_now(), HAL_RESET_WATCHDOG);
        CHECK_EQ(cause_now(), HAL_RESET_WATCHDOG);
        CHECK_EQ(hal_watchdog_feed(fixture->watchdog), HAL_ERROR_DOWN); // must be started again
    }
    reset();
    CHECK_EQ(cause_now(), HAL_RESET_POWER_ON);
}

/// A feed that failed did not feed; a start that failed did not start.
static void exercise(struct contract_plan *plan) {
    const uint32_t quarter_us = fixture->timeout_us_min / 4U;
    if (contract_failed(plan, hal_watchdog_start(fixture->watchdog, fixture->timeout_us_min))) {
        pass(2U * fixture->timeout_us_min);
        CHECK(!has_fired());
        CHECK(
            !contract_failed(plan, hal_watchdog_start(fixture->watchdog, fixture->timeout_us_min)));
    }
    for (int i = 0; i < 4; i++) {
        enum hal_reset_cause cause = HAL_RESET_PIN;
        if (contract_failed(plan, hal_watchdog_reset_cause(fixture->watchdog, &cause))) {
            CHECK_EQ(cause, HAL_RESET_PIN);
        }
        pass(quarter_us);
        if (contract_failed(plan, hal_watchdog_feed(fixture->watchdog))) {
            pass(4U * quarter_us);
            CHECK(has_fired());
            return;
        }
        CHECK(!has_fired());
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void watchdog_suite(const struct watchdog_fixture *with) {
    fixture = with;
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, fed_in_time_it_rests);
    CONTRACT(with->name, hungry_it_fires);
    CONTRACT(with->name, reset_cause_is_told);
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}

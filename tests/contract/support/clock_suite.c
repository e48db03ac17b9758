#include "contract/support/clock_suite.h"

#include "contract/support/contract.h"

static const struct clock_fixture *fixture;

static void every_op(void) {
    CONTRACT_EVERY_OP(clock, fixture->clock);
}

static void never_backwards(void) {
    uint32_t before = hal_clock_now_us(fixture->clock);
    for (int i = 0; i < 10000 && check_clean(); i++) {
        const uint32_t now = hal_clock_now_us(fixture->clock);
        CHECK(hal_clock_span_us(before, now) < UINT32_C(0x80000000));
        before = now;
    }
}

static void measures_time(void) {
    const uint32_t spans_us[] = {1, 2, 999, 1000, 20000};
    for (size_t i = 0; i < sizeof spans_us / sizeof spans_us[0]; i++) {
        const uint32_t before = hal_clock_now_us(fixture->clock);
        fixture->pass(fixture->context, spans_us[i]);
        const uint32_t span = hal_clock_span_us(before, hal_clock_now_us(fixture->clock));
        CHECK(span + 1U >= spans_us[i]); // both ends are cut to microseconds
        CHECK(span <= spans_us[i] + fixture->slack_us);
    }
}

/// Timers must not notice that the number wraps.
static void wraps_at_2_to_32(void) {
    const uint32_t start = UINT32_MAX - 4999U;
    uint32_t before = 0;
    for (int i = 0; i < 100 && before < start; i++) { // a busy machine may stop us in between
        fixture->start_at(fixture->context, start);
        before = hal_clock_now_us(fixture->clock);
    }
    CHECK(before >= start);
    const uint32_t deadline = before + 10000U;
    CHECK(deadline < before);
    CHECK(!hal_clock_has_reached(before, deadline));
    fixture->pass(fixture->context, 10001);
    const uint32_t after = hal_clock_now_us(fixture->clock);
    CHECK(after < before);
    CHECK(hal_clock_span_us(before, after) >= 10000U);
    CHECK(hal_clock_span_us(before, after) <= 10001U + fixture->slack_us);
    CHECK(hal_clock_has_reached(after, deadline));
    fixture->start_at(fixture->context, UINT32_MAX);
    fixture->pass(fixture->context, 1);
    CHECK(hal_clock_now_us(fixture->clock) <= 1U + fixture->slack_us);
}

/// The arithmetic, against 64 bits that don't wrap.
static void spans_and_deadlines(void) {
    const uint64_t starts[] = {0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFF0000, 0xFFFFFFFF, 0x123456789A};
    const uint64_t spans[] = {0, 1, 0xFFFF, 0x10000, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF};
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++) {
        for (size_t k = 0; k < sizeof spans / sizeof spans[0]; k++) {
            const uint32_t then = (uint32_t)starts[i], now = (uint32_t)(starts[i] + spans[k]);
            CHECK_EQ(hal_clock_span_us(then, now), spans[k]);
            if (spans[k] <= 0x7FFFFFFFU) {
                CHECK(hal_clock_has_reached(now, then));
                CHECK_EQ(hal_clock_has_reached(then, now), spans[k] == 0U);
            }
        }
    }
}

void clock_suite(const struct clock_fixture *with) {
    fixture = with;
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, spans_and_deadlines);
    CONTRACT(with->name, never_backwards);
    CONTRACT_IF(with->pass, "the rig can't let time pass", with->name, measures_time);
    CONTRACT_IF(with->start_at && with->pass, "the clock can't be set", with->name,
                wraps_at_2_to_32);
}

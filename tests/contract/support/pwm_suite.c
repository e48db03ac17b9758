#include "contract/support/pwm_suite.h"

#include "contract/support/contract.h"

#define CHANNELS_MAX 32U

static const struct pwm_fixture *fixture;
static uint64_t seed;

static void reset(void) {
    fixture->reset(fixture->context);
}

static struct hal_pwm_limits limits_of(uint32_t channel) {
    struct hal_pwm_limits limits = {0};
    CHECK_EQ(hal_pwm_limits(fixture->pwm, channel, &limits), HAL_OK);
    return limits;
}

/// Nearest multiple of the resolution, but 0 only for 0; in 64 bits and another way than the HAL.
static uint64_t rounded(uint64_t ns, uint64_t resolution_ns) {
    uint64_t below = ns - ns % resolution_ns;
    if (2U * (ns - below) >= resolution_ns) {
        below += resolution_ns;
    }
    return ns != 0U && below == 0U ? resolution_ns : below;
}

/// How far a period may be from what was asked for.
static uint32_t period_error_ns(const struct hal_pwm_limits *limits) {
    return (fixture->period_step_ns > 0U ? fixture->period_step_ns : limits->resolution_ns) / 2U;
}

static void expect_pulse(uint32_t channel, uint64_t pulse_ns) {
    uint32_t got_pulse_ns, got_period_ns;
    fixture->measure(fixture->context, channel, &got_pulse_ns, &got_period_ns);
    const struct hal_pwm_limits limits = limits_of(channel);
    CHECK_NEAR(got_pulse_ns, rounded(pulse_ns, limits.resolution_ns),
               pulse_ns == 0U ? 0U : fixture->measure_error_ns);
    CHECK_NEAR(got_period_ns, limits.period_ns, fixture->measure_error_ns);
}

static void every_op(void) {
    CONTRACT_EVERY_OP(pwm, fixture->pwm);
}

static void arguments(void) {
    reset();
    const uint32_t beyond[] = {fixture->channel_count, fixture->channel_count + 1U, 0x80000000U,
                               UINT32_MAX};
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        struct hal_pwm_limits limits = {.period_ns = 77};
        CHECK_EQ(hal_pwm_limits(fixture->pwm, beyond[i], &limits), HAL_ERROR_ARGUMENT);
        CHECK_EQ(limits.period_ns, 77);
        CHECK_EQ(hal_pwm_set_period(fixture->pwm, beyond[i], 20000000), HAL_ERROR_ARGUMENT);
        CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, beyond[i], 0), HAL_ERROR_ARGUMENT);
    }
    CHECK_EQ(hal_pwm_limits(fixture->pwm, 0, NULL), HAL_ERROR_ARGUMENT);
}

/// Servos need 50 Hz; a device that can't give it is no use.
static void limits_make_sense(void) {
    reset();
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        const struct hal_pwm_limits limits = limits_of(channel);
        CHECK(limits.period_ns_min <= limits.period_ns && limits.period_ns <= limits.period_ns_max);
        CHECK(limits.period_ns_min <= 20000000U && 20000000U <= limits.period_ns_max);
        CHECK(limits.resolution_ns >= 1U && limits.resolution_ns <= 10000U);
        CHECK(limits.period_ns_max <= UINT32_MAX - limits.resolution_ns);
    }
}

static void silent_after_reset(void) {
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, 1500000), HAL_OK);
    }
    reset();
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        expect_pulse(channel, 0);
    }
}

static void pulse_widths(void) {
    reset();
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        const struct hal_pwm_limits limits = limits_of(channel);
        const uint32_t step = limits.resolution_ns, period = limits.period_ns;
        const uint32_t widths[] = {1,       step - step / 2U, step,    step + (step - 1U) / 2U,
                                   500000,  1499999,          1500000, 1500001,
                                   2500000, period - step};
        for (size_t i = 0; i < sizeof widths / sizeof widths[0]; i++) {
            CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, widths[i]), HAL_OK);
            expect_pulse(channel, widths[i]);
        }
        const uint32_t too_long[] = {period, period + 1U, 0x80000000U, UINT32_MAX};
        for (size_t i = 0; i < sizeof too_long / sizeof too_long[0]; i++) {
            CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, too_long[i]), HAL_ERROR_ARGUMENT);
            expect_pulse(channel, period - step);
        }
        if (step > 1U) { // would round up to the whole period
            CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, period - 1U), HAL_ERROR_ARGUMENT);
        }
        CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, 0), HAL_OK);
        expect_pulse(channel, 0);
    }
}

static void channels_keep_apart(void) {
    reset();
    uint32_t pulse_ns[CHANNELS_MAX] = {0};
    for (int i = 0; i < 300 && check_clean(); i++) {
        const uint32_t channel = (uint32_t)(check_random(&seed) % fixture->channel_count);
        pulse_ns[channel] = (uint32_t)(check_random(&seed) % 2500000U);
        CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, pulse_ns[channel]), HAL_OK);
        for (uint32_t other = 0; other < fixture->channel_count; other++) {
            expect_pulse(other, pulse_ns[other]);
        }
    }
}

/// Whatever channels share a timer: each pin does what hal_pwm_limits says, pulses stay as they
/// are.
static void periods(void) {
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        reset();
        for (uint32_t other = 0; other < fixture->channel_count; other++) {
            CHECK_EQ(hal_pwm_set_period(fixture->pwm, other, 20000000), HAL_OK);
            CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, other, 1000000U + other * 10000U), HAL_OK);
        }
        const struct hal_pwm_limits limits = limits_of(channel);
        const uint32_t good[] = {limits.period_ns_max, 20000000, 3333333, 2500000};
        for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
            if (good[i] < limits.period_ns_min) {
                continue;
            }
            CHECK_EQ(hal_pwm_set_period(fixture->pwm, channel, good[i]), HAL_OK);
            CHECK_NEAR(limits_of(channel).period_ns, good[i], period_error_ns(&limits));
            for (uint32_t other = 0; other < fixture->channel_count; other++) {
                expect_pulse(other, 1000000U + other * 10000U);
            }
        }
        const struct hal_pwm_limits before = limits_of(channel);
        const uint32_t bad[] = {0, limits.period_ns_min - 1U, limits.period_ns_max + 1U, UINT32_MAX,
                                1000000U + channel * 10000U};
        for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
            CHECK_EQ(hal_pwm_set_period(fixture->pwm, channel, bad[i]), HAL_ERROR_ARGUMENT);
        }
        CHECK_EQ(limits_of(channel).period_ns, before.period_ns);
        expect_pulse(channel, 1000000U + channel * 10000U);
        CHECK_EQ(hal_pwm_set_pulse(fixture->pwm, channel, 0), HAL_OK);
    }
}

static void shortest_period(void) {
    reset();
    for (uint32_t channel = 0; channel < fixture->channel_count; channel++) {
        const struct hal_pwm_limits limits = limits_of(channel);
        CHECK_EQ(hal_pwm_set_period(fixture->pwm, channel, limits.period_ns_min), HAL_OK);
        CHECK_NEAR(limits_of(channel).period_ns, limits.period_ns_min, period_error_ns(&limits));
        expect_pulse(channel, 0);
    }
}

static void exercise(struct contract_plan *plan) {
    for (uint32_t i = 1; i <= 2U * fixture->channel_count; i++) {
        const uint32_t channel = i % fixture->channel_count, width_ns = 600000U + i * 20000U;
        uint32_t before_ns, after_ns, period_ns, period_after_ns;
        fixture->measure(fixture->context, channel, &before_ns, &period_ns);
        if (contract_failed(plan, hal_pwm_set_pulse(fixture->pwm, channel, width_ns))) {
            fixture->measure(fixture->context, channel, &after_ns, &period_after_ns);
            CHECK_NEAR(after_ns, before_ns, fixture->measure_error_ns);
            CHECK(!contract_failed(plan, hal_pwm_set_pulse(fixture->pwm, channel, width_ns)));
        }
        if (contract_failed(plan, hal_pwm_set_period(fixture->pwm, channel, 19000000))) {
            fixture->measure(fixture->context, channel, &after_ns, &period_after_ns);
            CHECK_NEAR(period_after_ns, period_ns, fixture->measure_error_ns);
            CHECK(!contract_failed(plan, hal_pwm_set_period(fixture->pwm, channel, 19000000)));
        }
        fixture->measure(fixture->context, channel, &after_ns, &period_after_ns);
        const struct hal_pwm_limits now = limits_of(channel);
        CHECK_NEAR(after_ns, rounded(width_ns, now.resolution_ns), fixture->measure_error_ns);
        CHECK_NEAR(period_after_ns, 19000000, period_error_ns(&now) + fixture->measure_error_ns);
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void pwm_suite(const struct pwm_fixture *with) {
    fixture = with;
    seed = UINT64_C(0xD1342543DE82EF95);
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, limits_make_sense);
    CONTRACT_IF(with->measure, "nothing measures the pulses", with->name, silent_after_reset);
    CONTRACT_IF(with->measure, "nothing measures the pulses", with->name, pulse_widths);
    CONTRACT_IF(with->measure && with->channel_count <= CHANNELS_MAX, "nothing measures the pulses",
                with->name, channels_keep_apart);
    CONTRACT_IF(with->measure, "nothing measures the pulses", with->name, periods);
    CONTRACT_IF(with->measure, "nothing measures the pulses", with->name, shortest_period);
    CONTRACT_IF(with->measure && with->fail_at, "the rig can't make calls fail", with->name,
                fails_at_every_call);
}

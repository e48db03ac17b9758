#include "contract/support/gpio_suite.h"

#include "contract/support/contract.h"

#define LINES_MAX 64U

const struct hal_gpio_line gpio_suite_lines[GPIO_SUITE_LINES] = {
    {HAL_GPIO_INPUT, HAL_GPIO_PULL_UP, .active_low = false},
    {HAL_GPIO_INPUT, HAL_GPIO_PULL_UP, .active_low = true},
    {HAL_GPIO_OUTPUT, HAL_GPIO_PULL_NONE, .active_low = false},
    {HAL_GPIO_OUTPUT, HAL_GPIO_PULL_NONE, .active_low = true},
    {HAL_GPIO_OUTPUT, HAL_GPIO_PULL_NONE, .active_low = false, .initially_active = true},
    {HAL_GPIO_OUTPUT, HAL_GPIO_PULL_NONE, .active_low = true, .initially_active = true},
    {HAL_GPIO_INPUT, HAL_GPIO_PULL_DOWN, .active_low = true},
    {HAL_GPIO_INPUT, HAL_GPIO_PULL_DOWN, .active_low = false}};

static const struct gpio_fixture *fixture;
static uint64_t seed;

static void reset(void) {
    fixture->reset(fixture->context);
}

static bool is_output(uint32_t line) {
    return fixture->lines[line].direction == HAL_GPIO_OUTPUT;
}

static bool read_line(uint32_t line) {
    bool active = false, again = true;
    CHECK_EQ(hal_gpio_read(fixture->gpio, line, &active), HAL_OK);
    CHECK_EQ(hal_gpio_read(fixture->gpio, line, &again), HAL_OK);
    CHECK_EQ(active, again);
    return active;
}

static void every_op(void) {
    CONTRACT_EVERY_OP(gpio, fixture->gpio);
}

static void arguments(void) {
    reset();
    const uint32_t beyond[] = {fixture->line_count, fixture->line_count + 1U, 0x80000000U,
                               UINT32_MAX};
    for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
        bool active = (i & 1U) != 0U;
        CHECK_EQ(hal_gpio_read(fixture->gpio, beyond[i], &active), HAL_ERROR_ARGUMENT);
        CHECK_EQ(active, (i & 1U) != 0U);
        CHECK_EQ(hal_gpio_write(fixture->gpio, beyond[i], true), HAL_ERROR_ARGUMENT);
    }
    for (uint32_t line = 0; line < fixture->line_count; line++) {
        CHECK_EQ(hal_gpio_read(fixture->gpio, line, NULL), HAL_ERROR_ARGUMENT);
        if (!is_output(line)) {
            CHECK_EQ(hal_gpio_write(fixture->gpio, line, true), HAL_ERROR_ARGUMENT);
            CHECK_EQ(hal_gpio_write(fixture->gpio, line, false), HAL_ERROR_ARGUMENT);
        }
    }
}

static void outputs_start_as_the_table_says(void) {
    reset();
    for (uint32_t line = 0; line < fixture->line_count; line++) {
        if (is_output(line)) {
            CHECK_EQ(read_line(line), fixture->lines[line].initially_active);
        }
    }
}

/// Written in any order, every output keeps what was written to it last.
static void outputs_keep_apart(void) {
    reset();
    bool active[LINES_MAX];
    for (uint32_t line = 0; line < fixture->line_count; line++) {
        active[line] = fixture->lines[line].initially_active;
    }
    for (int i = 0; i < 500 && check_clean(); i++) {
        const uint64_t dice = check_random(&seed);
        const uint32_t chosen = (uint32_t)(dice >> 32) % fixture->line_count;
        if (is_output(chosen)) {
            active[chosen] = (dice & 1U) != 0U;
            CHECK_EQ(hal_gpio_write(fixture->gpio, chosen, active[chosen]), HAL_OK);
        }
        for (uint32_t line = 0; line < fixture->line_count; line++) {
            if (is_output(line)) {
                CHECK_EQ(read_line(line), active[line]);
                CHECK(fixture->is_high == NULL ||
                      fixture->is_high(fixture->context, line) ==
                          (active[line] != fixture->lines[line].active_low));
            }
        }
    }
}

static void inputs_follow_their_pins(void) {
    reset();
    for (uint32_t pattern = 0; pattern < 512U && check_clean(); pattern++) {
        for (uint32_t line = 0; line < fixture->line_count; line++) {
            if (!is_output(line)) {
                fixture->drive(fixture->context, line, (pattern >> line % 8U & 1U) != 0U);
            }
        }
        for (uint32_t line = 0; line < fixture->line_count; line++) {
            const bool high = (pattern >> line % 8U & 1U) != 0U;
            if (!is_output(line)) {
                CHECK_EQ(read_line(line), high != fixture->lines[line].active_low);
            }
        }
    }
}

/// An input with nothing connected is where its resistor pulls it.
static void open_inputs_are_pulled(void) {
    reset();
    for (uint32_t line = 0; line < fixture->line_count; line++) {
        const struct hal_gpio_line *row = &fixture->lines[line];
        if (!is_output(line) && row->pull != HAL_GPIO_PULL_NONE) {
            CHECK_EQ(read_line(line), (row->pull == HAL_GPIO_PULL_UP) != row->active_low);
        }
    }
}

static void exercise(struct contract_plan *plan) {
    for (uint32_t i = 0; i < 2U * fixture->line_count; i++) {
        const uint32_t line = i % fixture->line_count;
        bool active = true;
        if (contract_failed(plan, hal_gpio_read(fixture->gpio, line, &active))) {
            CHECK(active);
            CHECK(!contract_failed(plan, hal_gpio_read(fixture->gpio, line, &active)));
        }
        if (is_output(line)) {
            CONTRACT_DO(plan, hal_gpio_write(fixture->gpio, line, !active));
            bool now = active;
            CONTRACT_DO(plan, hal_gpio_read(fixture->gpio, line, &now));
            CHECK_EQ(now, !active);
        }
    }
}

static void fails_at_every_call(void) {
    contract_each_failure(
        &(struct contract_failures){fixture->context, fixture->reset, fixture->fail_at, false},
        exercise);
}

void gpio_suite(const struct gpio_fixture *with) {
    fixture = with;
    seed = UINT64_C(0xBF58476D1CE4E5B9);
    CONTRACT(with->name, every_op);
    CONTRACT(with->name, arguments);
    CONTRACT(with->name, outputs_start_as_the_table_says);
    CONTRACT_IF(with->line_count <= LINES_MAX, "too many lines for the suite", with->name,
                outputs_keep_apart);
    CONTRACT_IF(with->drive, "nothing drives the inputs", with->name, inputs_follow_their_pins);
    CONTRACT(with->name, open_inputs_are_pulled);
    CONTRACT_IF(with->fail_at, "the rig can't make calls fail", with->name, fails_at_every_call);
}

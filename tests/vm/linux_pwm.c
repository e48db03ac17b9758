/// The PWM driver on a PWM chip of the kernel's: the PCA9685, the servo board that everybody has,
/// on an I2C bus whose chip is a bank of registers. What the servos would get is read back from
/// those, on another way than the driver's.
#include "linux/linux_pwm.h"
#include "contract/support/contract.h"
#include "contract/support/failing_pwm.h"
#include "contract/support/lives.h"
#include "contract/support/pwm_suite.h"
#include "contract/support/syscalls.h"
#include "linux/linux_gpio.h"
#include "vm/support/nobody.h"
#include "vm/support/sim_pca9685.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define OUTPUTS        16U
#define SUITE_OUTPUTS  6U ///< more take longer and say nothing new
#define ALL            ((1U << SUITE_OUTPUTS) - 1U)
#define PERIOD_STEP_NS 163840U ///< 4096 counts of 40 ns

static struct linux_pwm pwm;
static struct failing_pwm failing;
static char chip[32]; ///< pwmchipN

static void open_outputs(struct linux_pwm *at, uint32_t outputs) {
    if (!CHECK_EQ(linux_pwm_open(at, LINUX_PWM_ROOT, chip, outputs), HAL_OK)) {
        printf("  %s\n", at->error.line);
    }
}

static void reset(void *context) {
    (void)context;
    linux_pwm_close(&pwm);
    open_outputs(&pwm, ALL);
    failing_pwm_init(&failing, &pwm.hal);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_pwm_at(&failing, nth, status);
}

/// The pin shows no period while it is silent: what it will be is what the kernel was told.
static void measure(void *context, uint32_t output, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    sim_pca9685_measure(output, pulse_ns, period_ns);
    if (*pulse_ns == 0U) {
        char path[120];
        unsigned number = 0;
        snprintf(path, sizeof path, LINUX_PWM_ROOT "/%s/pwm%u/period", chip, (unsigned)output);
        FILE *file = fopen(path, "r");
        CHECK(file != NULL && fscanf(file, "%u", &number) == 1 && fclose(file) == 0);
        *period_ns = number;
    }
}

static void expect(uint32_t output, uint32_t pulse_ns) {
    uint32_t got_ns, period_ns;
    sim_pca9685_measure(output, &got_ns, &period_ns);
    CHECK_EQ(got_ns, pulse_ns);
}

static void expect_line(const struct linux_pwm *at, const char *format) {
    char wanted[LINUX_ERROR_BYTES];
    snprintf(wanted, sizeof wanted, format, chip);
    if (!CHECK(strcmp(at->error.line, wanted) == 0)) {
        printf("  got    %s\n  wanted %s\n", at->error.line, wanted);
    }
}

/// A servo's 0.5 to 2.5 ms: within half a step everywhere, and to neither side on the whole.
static void pulses_are_the_nearest(void) {
    int64_t sum_ns = 0;
    reset(NULL);
    for (uint32_t i = 0; i < 500U; i++) {
        const uint32_t wanted_ns = 500000U + 4001U * i;
        uint32_t got_ns, period_ns;
        CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 3, wanted_ns), HAL_OK);
        sim_pca9685_measure(3, &got_ns, &period_ns);
        CHECK_NEAR(got_ns, wanted_ns, 2440);
        CHECK_EQ(period_ns, 122U * PERIOD_STEP_NS);
        sum_ns += (int64_t)got_ns - wanted_ns;
    }
    CHECK_NEAR(sum_ns / 500, 0, 200);
}

static void closing_ends_the_pulses(void) {
    reset(NULL);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_OK);
    expect(1, 307U * 4880U);
    linux_pwm_close(&pwm);
    expect(1, 0);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_ERROR_GONE);
    expect(1, 0);
}

/// The chip's only period is that of whoever gives pulses already.
static void another_program_keeps_its_period(void) {
    struct linux_pwm other;
    linux_pwm_close(&pwm);
    open_outputs(&pwm, 1U);
    open_outputs(&other, 2U);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 0, 1500000), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&other.hal, 1, 1000000), HAL_OK);
    CHECK_EQ(hal_pwm_set_period(&other.hal, 1, 10000000), HAL_ERROR_DENIED);
    expect_line(&other, "%s output 1: in use by another program; end that one first (`fuser -v` on "
                        "the file shows it)");
    expect(0, 307U * 4880U);
    expect(1, 205U * 4880U);
    linux_pwm_close(&other);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 10000000), HAL_OK);
    expect(0, 615U * 2440U);
}

/// An output that was taken as a GPIO line is another's.
static void output_in_use(void) {
    static const struct hal_gpio_line line = {.direction = HAL_GPIO_OUTPUT};
    struct linux_gpio gpio;
    struct linux_gpio_chip chips[4];
    sim_pca9685_remove(); // what was exported is held
    sim_pca9685_create(chip, sizeof chip);
    CHECK_EQ(linux_gpio_list(chips, 4), 1); // the driver offers its outputs as lines, too
    const struct linux_gpio_pin pin = {chips[0].name, 5};
    if (!CHECK_EQ(linux_gpio_open(&gpio, &line, &pin, 1), HAL_OK)) {
        printf("  %s\n", gpio.error.line);
    }
    CHECK_EQ(linux_pwm_open(&pwm, LINUX_PWM_ROOT, chip, 1U << 5), HAL_ERROR_DENIED);
    expect_line(&pwm, "%s output 5: in use by another program; end that one first (`fuser -v` on "
                      "the file shows it)");
    linux_gpio_close(&gpio);
    open_outputs(&pwm, 1U << 5);
}

static void chip_leaves_and_returns(void) {
    for (int round = 0; round < 3; round++) {
        reset(NULL);
        CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 2, 1500000), HAL_OK);
        expect(2, 307U * 4880U);
        CHECK_EQ(linux_pwm_poll(&pwm), HAL_OK);
        sim_pca9685_remove();
        expect(2, 0);
        struct hal_pwm_limits limits;
        if (round == 2) { // found without a pulse that changes
            CHECK_EQ(linux_pwm_poll(&pwm), HAL_ERROR_GONE);
            expect_line(&pwm, "%s output 0: the chip has gone; was its driver unloaded?");
            CHECK_EQ(hal_pwm_limits(&pwm.hal, 2, &limits), HAL_ERROR_GONE);
            sim_pca9685_create(chip, sizeof chip);
            continue;
        }
        CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 2, 1500000), HAL_ERROR_GONE);
        expect_line(&pwm, "%s output 2: the chip has gone; was its driver unloaded?");
        CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 3, 0), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_set_period(&pwm.hal, 3, 20000000), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_limits(&pwm.hal, 2, &limits), HAL_ERROR_GONE);
        linux_pwm_close(&pwm);
        CHECK_EQ(linux_pwm_open(&pwm, LINUX_PWM_ROOT, chip, ALL), HAL_ERROR_GONE);
        expect_line(&pwm,
                    "%s: no such PWM chip; is the overlay loaded (pwm-2chan, i2c-pwm-pca9685a)? "
                    "`boresight probe` lists the chips");
        expect(2, 0);
        sim_pca9685_create(chip, sizeof chip);
    }
}

static void chips_are_listed(void) {
    struct linux_pwm_chip chips[4];
    CHECK_EQ(linux_pwm_list(LINUX_PWM_ROOT, chips, 4), 1);
    CHECK(strcmp(chips[0].name, chip) == 0 && strcmp(chips[0].driver, "pca9685-pwm") == 0);
    CHECK_EQ(chips[0].channel_count, OUTPUTS); // and not the one for all at once
    CHECK_EQ(linux_pwm_open(&pwm, LINUX_PWM_ROOT, chip, 1U << 16), HAL_ERROR_ARGUMENT);
    expect_line(&pwm, "%s: has 16 outputs, 0 to 15; choose another channel");
}

static void live(void) {
    struct hal_pwm_limits limits = {0};
    if (life_note("open", linux_pwm_open(&pwm, LINUX_PWM_ROOT, chip, 5U), &pwm.error) != HAL_OK) {
        CHECK_EQ(hal_pwm_limits(&pwm.hal, 2, &limits), HAL_ERROR_GONE);
        return;
    }
    life_note("pulse", hal_pwm_set_pulse(&pwm.hal, 2, 1500000), &pwm.error);
    life_note("limits", hal_pwm_limits(&pwm.hal, 2, &limits), &pwm.error);
    life_value("resolution", limits.resolution_ns);
    life_note("period", hal_pwm_set_period(&pwm.hal, 2, 10000000), &pwm.error);
    life_note("poll", linux_pwm_poll(&pwm), &pwm.error);
    linux_pwm_close(&pwm);
}

static void fails_at_every_step(void) {
    const struct life_error errors[] = {
        LIFE_EIO, LIFE_ENODEV, LIFE_ENOMEM, {EBUSY, LIFE_STATUS(HAL_ERROR_DENIED)}};
    linux_pwm_close(&pwm);
    lives_each_failure(&(struct lives){.device = chip,
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 4,
                                       .share_out = true,
                                       .stride = LIVES_VM_STRIDE,
                                       .recover_every = 4,
                                       .dies = true});
}

/// The kernel's files are root's.
static void forbidden(void) {
    struct hal_pwm_limits limits;
    linux_pwm_close(&pwm);
    sim_pca9685_remove(); // what was exported is open to its owner
    sim_pca9685_create(chip, sizeof chip);
    nobody_begin();
    CHECK_EQ(linux_pwm_open(&pwm, LINUX_PWM_ROOT, chip, 1U), HAL_ERROR_DENIED);
    CHECK(strstr(pwm.error.line, " output 0: no permission; ") != NULL);
    CHECK_EQ(hal_pwm_limits(&pwm.hal, 0, &limits), HAL_ERROR_GONE);
    nobody_end();
}

int main(void) {
    sim_pca9685_create(chip, sizeof chip);
    reset(NULL);
    pwm_suite(&(struct pwm_fixture){.name = "linux_pwm",
                                    .pwm = &failing.hal,
                                    .channel_count = SUITE_OUTPUTS,
                                    .reset = reset,
                                    .measure = measure,
                                    .period_step_ns = PERIOD_STEP_NS,
                                    .fail_at = fail_at});
    CONTRACT("linux_pwm", pulses_are_the_nearest);
    CONTRACT("linux_pwm", closing_ends_the_pulses);
    CONTRACT("linux_pwm", another_program_keeps_its_period);
    CONTRACT_IF(linux_gpio_library() != NULL, "built without libgpiod", "linux_pwm", output_in_use);
    CONTRACT("linux_pwm", chip_leaves_and_returns);
    CONTRACT("linux_pwm", chips_are_listed);
    CONTRACT("linux_pwm", fails_at_every_step);
    CONTRACT("linux_pwm", forbidden);
    linux_pwm_close(&pwm);
    sim_pca9685_remove();
    return check_finish();
}

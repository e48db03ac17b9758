/// The PWM driver on files that stand for those of /sys/class/pwm. They keep what is written to
/// them and check nothing; what the kernel would refuse is looked for here.
#include "linux/linux_pwm.h"
#include "contract/support/contract.h"
#include "contract/support/failing_pwm.h"
#include "contract/support/lives.h"
#include "contract/support/pwm_suite.h"
#include "contract/support/syscalls.h"

#include <errno.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define CHANNELS 4U

static struct linux_pwm pwm;
static struct failing_pwm failing;
static const char *driver; ///< of the chip; null: it doesn't tell
static char root[] = "/tmp/boresight-pwm-XXXXXX";

static void put(const char *file, const char *text) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", root, file);
    FILE *stream = fopen(path, "w");
    if (CHECK(stream != NULL)) {
        fputs(text, stream);
        fclose(stream);
    }
}

static uint32_t get(const char *file) {
    char path[300];
    unsigned number = 0;
    snprintf(path, sizeof path, "%s/%s", root, file);
    FILE *stream = fopen(path, "r");
    if (CHECK(stream != NULL)) {
        CHECK_EQ(fscanf(stream, "%u", &number), 1);
        fclose(stream);
    }
    return number;
}

static uint32_t get_of(uint32_t channel, const char *file) {
    char path[64];
    snprintf(path, sizeof path, "pwmchip3/pwm%u/%s", (unsigned)channel, file);
    return get(path);
}

static void make_chip(void) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwmchip3", root);
    mkdir(path, 0755);
    put("pwmchip3/npwm", "4\n");
    put("pwmchip3/export", "");
    snprintf(path, sizeof path, "%s/pwmchip3/device", root);
    mkdir(path, 0755);
    snprintf(path, sizeof path, "%s/pwmchip3/device/driver", root);
    (void)unlink(path);
    CHECK(driver == NULL || symlink(driver, path) == 0);
    for (unsigned i = 0; i < CHANNELS; i++) {
        char file[64];
        snprintf(path, sizeof path, "%s/pwmchip3/pwm%u", root, i);
        mkdir(path, 0755);
        // As a program left them that died.
        snprintf(file, sizeof file, "pwmchip3/pwm%u/period", i);
        put(file, "5000000\n");
        snprintf(file, sizeof file, "pwmchip3/pwm%u/duty_cycle", i);
        put(file, "1500000\n");
        snprintf(file, sizeof file, "pwmchip3/pwm%u/enable", i);
        put(file, "1\n");
    }
}

static void reset(void *context) {
    (void)context;
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 15), HAL_OK);
    failing_pwm_init(&failing, &pwm.hal);
}

static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    return failing_pwm_at(&failing, nth, status);
}

static void measure(void *context, uint32_t channel, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    *period_ns = get_of(channel, "period");
    *pulse_ns = get_of(channel, "enable") == 1U ? get_of(channel, "duty_cycle") : 0U;
    CHECK(*pulse_ns < *period_ns); // else the kernel would have refused it
}

static void closing_ends_the_pulses(void) {
    reset(NULL);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_OK);
    CHECK_EQ(get_of(1, "enable"), 1);
    linux_pwm_close(&pwm);
    CHECK_EQ(get_of(1, "enable"), 0);
    CHECK_EQ(get_of(1, "duty_cycle"), 0);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_ERROR_GONE);
    CHECK_EQ(get_of(1, "duty_cycle"), 0);
}

/// Also when no pulse changes for hours.
static void a_chip_that_leaves_is_noticed(void) {
    struct hal_pwm_limits limits;
    reset(NULL);
    CHECK_EQ(linux_pwm_poll(&pwm), HAL_OK);
    syscalls_at(2, SYSCALLS_FAIL, EIO);
    CHECK_EQ(linux_pwm_poll(&pwm), HAL_ERROR_IO); // it may come round
    CHECK_EQ(linux_pwm_poll(&pwm), HAL_OK);
    syscalls_at(3, SYSCALLS_FAIL, ENODEV);
    CHECK_EQ(linux_pwm_poll(&pwm), HAL_ERROR_GONE);
    CHECK(strcmp(pwm.error.line,
                 "pwmchip3 output 2: the chip has gone; was its driver unloaded?") == 0);
    CHECK_EQ(linux_pwm_poll(&pwm), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_limits(&pwm.hal, 0, &limits), HAL_ERROR_GONE);
    syscalls_at(0, SYSCALLS_FAIL, 0);
}

/// Only what was asked for is touched.
static void other_outputs_are_let_be(void) {
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 2), HAL_OK);
    CHECK_EQ(get_of(2, "enable"), 0);
    CHECK_EQ(get_of(1, "enable"), 1);
    CHECK_EQ(get_of(1, "period"), 5000000);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 2, 1500000), HAL_OK);
}

/// An output whose files are not there is asked for; here nobody makes them.
static void outputs_are_exported(void) {
    char path[300];
    linux_pwm_close(&pwm);
    put("pwmchip3/npwm", "6\n");
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 5), HAL_ERROR_GONE);
    CHECK_EQ(get("pwmchip3/export"), 5);
    CHECK(strncmp(pwm.error.line, "pwmchip3 output 5: no such file or device; is the overlay",
                  57) == 0);
    snprintf(path, sizeof path, "%s/pwmchip3/export", root);
    CHECK_EQ(unlink(path), 0);
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 4), HAL_ERROR_GONE);
}

static void refusals_say_what_to_do(void) {
    linux_pwm_close(&pwm);
    make_chip();
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip4", 1), HAL_ERROR_GONE);
    CHECK(strcmp(pwm.error.line,
                 "pwmchip4: no such PWM chip; is the overlay loaded "
                 "(pwm-2chan, i2c-pwm-pca9685a)? `boresight probe` lists the chips") == 0);
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 4), HAL_ERROR_ARGUMENT);
    CHECK(strcmp(pwm.error.line, "pwmchip3: has 4 outputs, 0 to 3; choose another channel") == 0);
    struct hal_pwm_limits limits;
    CHECK_EQ(hal_pwm_limits(&pwm.hal, 0, &limits), HAL_ERROR_GONE);
    CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 20000000), HAL_ERROR_GONE);
}

static void chips_are_listed(void) {
    char path[300];
    struct linux_pwm_chip chips[4];
    make_chip();
    snprintf(path, sizeof path, "%s/pwmchip12", root);
    mkdir(path, 0755);
    put("pwmchip12/npwm", "2\n");
    CHECK_EQ(linux_pwm_list(root, chips, 4), 2);
    CHECK(strcmp(chips[0].name, "pwmchip3") == 0 && chips[0].channel_count == 4U);
    CHECK(strcmp(chips[1].name, "pwmchip12") == 0 && chips[1].channel_count == 2U);
    CHECK_EQ(linux_pwm_list(root, chips, 1), 2);
    CHECK_EQ(linux_pwm_list("/nowhere", chips, 4), 0);
}

/// Whichever write of a change fails: what holds is the old pulses and the old period, and what
/// comes next works.
static void a_write_fails_whichever(void) {
    uint32_t writes = 1;
    for (uint32_t nth = 1; nth <= writes && check_clean(); nth++) {
        uint32_t pulse_ns, period_ns;
        reset(NULL);
        for (uint32_t i = 0; i < CHANNELS; i++) {
            CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, i, 976000U * (i % 3U)), HAL_OK);
        }
        const uint32_t before_ns = get_of(0, "period");
        syscalls_at(nth, SYSCALLS_FAIL, EIO);
        const enum hal_status changed = hal_pwm_set_period(&pwm.hal, 1, 4096000);
        CHECK(changed == HAL_OK || changed == HAL_ERROR_IO);
        const enum hal_status begun = hal_pwm_set_pulse(&pwm.hal, 0, 976000);
        const enum hal_status ended = hal_pwm_set_pulse(&pwm.hal, 1, 0);
        const bool failed = syscalls_met();
        writes = failed ? writes + 1U : writes;
        syscalls_at(0, SYSCALLS_FAIL, 0);
        CHECK_EQ((changed != HAL_OK) + (begun != HAL_OK) + (ended != HAL_OK), failed ? 1 : 0);
        measure(NULL, 1, &pulse_ns, &period_ns);
        CHECK_EQ(pulse_ns == 0U, ended == HAL_OK);
        CHECK_NEAR(period_ns, changed == HAL_OK ? 4096000U : before_ns, 0);
        measure(NULL, 0, &pulse_ns, &period_ns);
        CHECK_EQ(pulse_ns == 0U, begun != HAL_OK);
        measure(NULL, 2, &pulse_ns, &period_ns);
        CHECK_NEAR(pulse_ns, 1952000, 4000);
        CHECK_EQ(hal_pwm_set_period(&pwm.hal, 1, 20000000), HAL_OK);
        CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1500000), HAL_OK);
        measure(NULL, 1, &pulse_ns, &period_ns);
        CHECK_NEAR(pulse_ns, 1500000, 2440);
    }
    check_note("writes", writes - 1U);
}

/// A servo board whose steps are known: the kernel is asked for the nearest one, not for what it
/// would round up.
static void a_known_chip_gets_whole_steps(void) {
    reset(NULL);
    CHECK_EQ(get_of(0, "period"), 122 * 163840);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 0, 1500000), HAL_OK);
    CHECK_EQ(get_of(0, "duty_cycle"), 307 * 4880);
    CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 1, 1501000), HAL_OK);
    CHECK_EQ(get_of(1, "duty_cycle"), 308 * 4880);
    put("pwmchip3/npwm", "17\n"); // the kernel's last one is all of them at once
    linux_pwm_close(&pwm);
    CHECK_EQ(linux_pwm_open(&pwm, root, "pwmchip3", 1U << 16), HAL_ERROR_ARGUMENT);
    CHECK(strcmp(pwm.error.line, "pwmchip3: has 16 outputs, 0 to 15; choose another channel") == 0);
    struct linux_pwm_chip chip;
    CHECK_EQ(linux_pwm_list(root, &chip, 1), 1);
    CHECK_EQ(chip.channel_count, 16);
    CHECK(strcmp(chip.driver, "pca9685-pwm") == 0);
}

/// Whatever the chip's steps make of the two, its file never has a pulse as long as its period; and
/// what was refused changed nothing.
static void a_pulse_fits_into_its_period(void) {
    struct hal_pwm_limits limits;
    uint32_t taken = 0, refused = 0;
    reset(NULL);
    CHECK_EQ(get_of(0, "duty_cycle"), 0);
    for (uint32_t pulse_ns = 700000; pulse_ns < 3000000U; pulse_ns += 17777U) {
        for (uint32_t more_ns = 1; more_ns < 400000U; more_ns *= 3U) {
            CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 0, 0), HAL_OK);
            CHECK_EQ(hal_pwm_set_period(&pwm.hal, 0, 20000000), HAL_OK);
            CHECK_EQ(hal_pwm_set_pulse(&pwm.hal, 0, pulse_ns), HAL_OK);
            const enum hal_status status = hal_pwm_set_period(&pwm.hal, 0, pulse_ns + more_ns);
            CHECK(status == HAL_OK || status == HAL_ERROR_ARGUMENT);
            CHECK_EQ(hal_pwm_limits(&pwm.hal, 0, &limits), HAL_OK);
            CHECK_EQ(get_of(0, "period"), limits.period_ns);
            CHECK(limits.period_ns > pulse_ns && get_of(0, "duty_cycle") < limits.period_ns);
            CHECK(status == HAL_OK || limits.period_ns == 122U * 163840U);
            taken += status == HAL_OK;
            refused += status != HAL_OK;
            if (!check_clean()) {
                return;
            }
        }
    }
    CHECK(taken > 100U && refused > 100U);
}

static void live(void) {
    struct hal_pwm_limits limits = {0};
    if (life_note("open", linux_pwm_open(&pwm, root, "pwmchip3", 5U), &pwm.error) != HAL_OK) {
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
    make_chip();
    lives_each_failure(&(struct lives){
        .device = "pwmchip3", .live = live, .errors = errors, .error_count = 4, .dies = true});
}

static void suite(const char *name, uint32_t period_step_ns) {
    reset(NULL);
    pwm_suite(&(struct pwm_fixture){.name = name,
                                    .pwm = &failing.hal,
                                    .channel_count = CHANNELS,
                                    .reset = reset,
                                    .measure = measure,
                                    .period_step_ns = period_step_ns,
                                    .fail_at = fail_at});
    CONTRACT(name, a_write_fails_whichever);
    CONTRACT(name, fails_at_every_step);
}

int main(void) {
    if (mkdtemp(root) == NULL) {
        return 2;
    }
    driver = "/nowhere/drivers/pca9685-pwm";
    suite("linux_pwm_pca9685", 163840);
    CONTRACT("linux_pwm_pca9685", a_known_chip_gets_whole_steps);
    CONTRACT("linux_pwm_pca9685", a_pulse_fits_into_its_period);
    driver = NULL;
    suite("linux_pwm", 0);
    CONTRACT("linux_pwm", closing_ends_the_pulses);
    CONTRACT("linux_pwm", a_chip_that_leaves_is_noticed);
    CONTRACT("linux_pwm", other_outputs_are_let_be);
    CONTRACT("linux_pwm", outputs_are_exported);
    CONTRACT("linux_pwm", refusals_say_what_to_do);
    CONTRACT("linux_pwm", chips_are_listed);
    linux_pwm_close(&pwm);
    char command[100];
    snprintf(command, sizeof command, "rm -r %s", root);
    CHECK_EQ(system(command), 0);
    return check_finish();
}

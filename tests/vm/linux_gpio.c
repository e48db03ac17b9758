/// The GPIO driver on a bank of the kernel's gpio-sim, whose far side is in sysfs.
#include "linux/linux_gpio.h"
#include "contract/support/contract.h"
#include "contract/support/gpio_suite.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "linux/linux_gpio_pulses.h"
#include "linux/linux_gpio_steps.h"
#include "vm/support/nobody.h"
#include "vm/support/shell.h"
#include "vm/support/sim_gpio.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct linux_gpio gpio;
static struct linux_gpio_pin pins[GPIO_SUITE_LINES];
static char chip[32]; ///< gpiochipN

static void reset(void *context) {
    (void)context;
    syscalls_at(0, SYSCALLS_FAIL, 0);
    linux_gpio_close(&gpio);
    if (!CHECK_EQ(linux_gpio_open(&gpio, gpio_suite_lines, pins, GPIO_SUITE_LINES), HAL_OK)) {
        printf("  %s\n", gpio.error.line);
    }
}

/// Each reading and each setting is one call of the kernel; a chip that is gone stays so.
static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    syscalls_at(nth, SYSCALLS_FAIL, EIO);
    return status == HAL_ERROR_IO;
}

static void drive(void *context, uint32_t line, bool high) {
    (void)context;
    sim_gpio_drive(pins[line].offset, high);
}

static bool is_high(void *context, uint32_t line) {
    (void)context;
    return sim_gpio_is_high(pins[line].offset);
}

static void expect_refusal(const struct hal_gpio_line *line, struct linux_gpio_pin pin,
                           enum hal_status status, const char *text) {
    struct linux_gpio refused;
    char wanted[LINUX_ERROR_BYTES];
    snprintf(wanted, sizeof wanted, text, chip);
    CHECK_EQ(linux_gpio_open(&refused, line, &pin, 1), status);
    if (!CHECK(strcmp(refused.error.line, wanted) == 0)) {
        printf("  got    %s\n  wanted %s\n", refused.error.line, wanted);
    }
    linux_gpio_close(&refused);
}

static void refusals_say_what_to_do(void) {
    reset(NULL);
    expect_refusal(
        &gpio_suite_lines[0], (struct linux_gpio_pin){"gpiochip77", 1}, HAL_ERROR_GONE,
        "/dev/gpiochip77: no such file or device; `boresight probe` lists the GPIO chips");
    expect_refusal(&gpio_suite_lines[0], (struct linux_gpio_pin){chip, 16}, HAL_ERROR_ARGUMENT,
                   "%s:16: the chip has no such line; `boresight probe` tells how many it has");
    expect_refusal(&gpio_suite_lines[0], (struct linux_gpio_pin){chip, pins[0].offset},
                   HAL_ERROR_DENIED,
                   "%s:2: in use by 'boresight'; end that program, or take the overlay that claims "
                   "it out of the device tree");
    struct linux_gpio none;
    CHECK_EQ(linux_gpio_open(&none, gpio_suite_lines, pins, 0), HAL_ERROR_ARGUMENT);
}

/// What one program has let go another may have; and a failed opening holds nothing.
static void lines_are_given_back(void) {
    reset(NULL);
    struct linux_gpio other;
    const struct linux_gpio_pin mixed[] = {{chip, 0}, {chip, pins[3].offset}};
    CHECK_EQ(linux_gpio_open(&other, gpio_suite_lines, mixed, 2), HAL_ERROR_DENIED);
    linux_gpio_close(&gpio);
    CHECK_EQ(linux_gpio_open(&other, gpio_suite_lines, mixed, 2), HAL_OK);
    linux_gpio_close(&other);
}

/// By its label as well as by its name.
static void chips_have_two_names(void) {
    linux_gpio_close(&gpio);
    const struct linux_gpio_pin pin = {SIM_GPIO_LABEL, 4};
    CHECK_EQ(linux_gpio_open(&gpio, gpio_suite_lines, &pin, 1), HAL_OK);
    struct linux_gpio_chip chips[8];
    const uint32_t count = linux_gpio_list(chips, 8);
    CHECK(count >= 1U && count <= 8U);
    bool listed = false;
    for (uint32_t i = 0; i < count; i++) {
        listed = listed || (strcmp(chips[i].name, chip) == 0 && chips[i].line_count == 16U &&
                            strcmp(chips[i].label, SIM_GPIO_LABEL) == 0);
    }
    CHECK(listed);
}

// ---------------------------------------------------------------- pulses and steps, in real time

/// Nothing is claimed of times in an emulated machine: what is given is counted, and how late it
/// was is printed.
static void pulses_come_out(void) {
    static struct linux_gpio_pulses pulses;
    static const uint32_t channels[] = {9, 10};
    linux_gpio_close(&gpio);
    CHECK_EQ(linux_gpio_pulses_open(&pulses, chip, channels, 2), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 9, 1500000), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 10, 0), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 11, 0), HAL_ERROR_ARGUMENT);
    bool high = false, silent = true;
    struct linux_jitter jitter = {.step = 1000};
    for (int i = 0; i < 60000 && (!high || jitter.count < 50U); i++) {
        high = sim_gpio_is_high(9) || high;
        silent = silent && !sim_gpio_is_high(10);
        jitter = (struct linux_jitter){.step = 1000};
        linux_gpio_pulses_jitter(&pulses, &jitter);
        usleep(500);
    }
    CHECK(high && silent && jitter.count >= 50U);
    check_note("pulses, in the emulator", (int64_t)jitter.count);
    check_note("ns too long: half of them at most", (int64_t)linux_jitter_quantile(&jitter, 500));
    check_note("ns too long: 99 % at most", (int64_t)linux_jitter_quantile(&jitter, 990));
    check_note("ns too long: all at most", (int64_t)jitter.max);
    linux_gpio_pulses_close(&pulses);
    const uint32_t once[] = {9};
    CHECK_EQ(linux_gpio_pulses_open(&pulses, chip, once, 1), HAL_OK); // given back
    CHECK(!sim_gpio_is_high(9));
    linux_gpio_pulses_close(&pulses);
}

static void steps_come_out(void) {
    static struct linux_gpio_steps steps;
    CHECK_EQ(linux_gpio_steps_open(&steps, chip, 11, 12, 2000, 100), HAL_OK);
    CHECK_EQ(linux_gpio_steps_go(&steps, 400), HAL_OK);
    for (int i = 0; i < 60000 && linux_gpio_steps_position(&steps) != 400; i++) {
        usleep(500);
    }
    CHECK_EQ(linux_gpio_steps_position(&steps), 400);
    CHECK(sim_gpio_is_high(12)); // forward
    CHECK_EQ(linux_gpio_steps_go(&steps, 0), HAL_OK);
    for (int i = 0; i < 60000 && linux_gpio_steps_position(&steps) != 0; i++) {
        usleep(500);
    }
    CHECK_EQ(linux_gpio_steps_position(&steps), 0);
    CHECK(!sim_gpio_is_high(12));
    struct linux_jitter jitter = {.step = 1000};
    linux_gpio_steps_jitter(&steps, &jitter);
    CHECK_EQ(jitter.count, 700);
    check_note("ns late: 99 % of the steps at most", (int64_t)linux_jitter_quantile(&jitter, 990));
    linux_gpio_steps_close(&steps);
}

/// The chip is taken away from under everything that holds its lines, and comes back.
static void chip_leaves_and_returns(void) {
    static struct linux_gpio_pulses pulses;
    static struct linux_gpio_steps steps;
    static const uint32_t channels[] = {9};
    reset(NULL);
    CHECK_EQ(linux_gpio_steps_open(&steps, chip, 13, 14, 1000, 0), HAL_OK);
    CHECK_EQ(linux_gpio_steps_go(&steps, 1000000), HAL_OK);
    CHECK_EQ(linux_gpio_pulses_open(&pulses, chip, channels, 1), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 9, 1500000), HAL_OK);
    sim_gpio_remove();
    bool active;
    CHECK_EQ(hal_gpio_read(&gpio.hal, 0, &active), HAL_ERROR_GONE);
    CHECK(strstr(gpio.error.line, ": the chip has gone; was its adapter unplugged?") != NULL);
    CHECK_EQ(hal_gpio_write(&gpio.hal, 2, true), HAL_ERROR_GONE);
    struct hal_pwm_limits limits;
    int tries = 60000;
    while (tries > 0 && hal_pwm_limits(&pulses.hal, 9, &limits) != HAL_ERROR_GONE) {
        usleep(500);
        tries--;
    }
    while (tries > 0 && linux_gpio_steps_presence(&steps) != HAL_ERROR_GONE) {
        usleep(500);
        tries--;
    }
    CHECK(tries > 0);
    linux_gpio_steps_close(&steps);
    linux_gpio_pulses_close(&pulses);
    linux_gpio_close(&gpio);
    CHECK_EQ(linux_gpio_open(&gpio, gpio_suite_lines, pins, GPIO_SUITE_LINES), HAL_ERROR_GONE);
    sim_gpio_create(16, chip, sizeof chip);
    reset(NULL);
    CHECK_EQ(hal_gpio_read(&gpio.hal, 0, &active), HAL_OK);
    CHECK_EQ(linux_gpio_pulses_open(&pulses, chip, channels, 1), HAL_OK);
    linux_gpio_pulses_close(&pulses);
}

// ---------------------------------------------------------------- errors at every step

static void live_with_lines(void) {
    bool active = false;
    if (life_note("open", linux_gpio_open(&gpio, gpio_suite_lines, pins, 4), &gpio.error) !=
        HAL_OK) {
        CHECK_EQ(hal_gpio_read(&gpio.hal, 0, &active), HAL_ERROR_GONE);
        return;
    }
    for (uint32_t line = 0; line < 4U; line++) {
        if (gpio_suite_lines[line].direction == HAL_GPIO_OUTPUT) {
            life_note("write", hal_gpio_write(&gpio.hal, line, true), &gpio.error);
        }
        life_note("read", hal_gpio_read(&gpio.hal, line, &active), &gpio.error);
        life_value("active", active);
    }
    linux_gpio_close(&gpio);
}

/// Two pulses, or however many there are until a line fails.
static void live_with_pulses(void) {
    static struct linux_gpio_pulses pulses;
    static const uint32_t channels[] = {9, 10};
    const struct linux_error *error = &pulses.error;
    struct hal_pwm_limits limits = {0};
    struct linux_jitter jitter = {.step = 1000};
    if (life_note("open", linux_gpio_pulses_open(&pulses, chip, channels, 2), error) != HAL_OK) {
        CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 9, 1500000), HAL_ERROR_GONE);
        return;
    }
    life_note("period", hal_pwm_set_period(&pulses.hal, 9, 3000000), error);
    life_note("pulse", hal_pwm_set_pulse(&pulses.hal, 9, 1000000), error);
    for (int i = 0;
         i < 60000 && jitter.count < 2U && hal_pwm_limits(&pulses.hal, 9, &limits) == HAL_OK; i++) {
        usleep(500);
        jitter = (struct linux_jitter){.step = 1000};
        linux_gpio_pulses_jitter(&pulses, &jitter);
    }
    life_note("limits", hal_pwm_limits(&pulses.hal, 9, &limits), error);
    life_value("pulses", jitter.count >= 2U);
    linux_gpio_pulses_close(&pulses);
}

static void live_with_steps(void) {
    static struct linux_gpio_steps steps;
    const struct linux_error *error = &steps.error;
    if (life_note("open", linux_gpio_steps_open(&steps, chip, 11, 12, 2000, 0), error) != HAL_OK) {
        CHECK_EQ(linux_gpio_steps_presence(&steps), HAL_ERROR_GONE);
        return;
    }
    for (int64_t target = 2; target >= 0; target -= 2) {
        life_note("go", linux_gpio_steps_go(&steps, target), error);
        for (int i = 0; i < 60000 && linux_gpio_steps_position(&steps) != target &&
                        linux_gpio_steps_presence(&steps) == HAL_OK;
             i++) {
            usleep(500);
        }
        life_value("position", linux_gpio_steps_position(&steps));
    }
    life_note("presence", linux_gpio_steps_presence(&steps), error);
    linux_gpio_steps_close(&steps);
}

/// gone: what a line that can't be set any more is to the threads. The library looks at the chip's
/// file first, and has an error of its own then.
static void each_failure(void (*live)(void), uint32_t gone) {
    const uint32_t io = LIFE_STATUS(HAL_ERROR_IO) | LIFE_STATUS(HAL_ERROR_UNSUPPORTED) | gone;
    const struct life_error errors[] = {{EIO, io},
                                        {ENODEV, io | LIFE_STATUS(HAL_ERROR_GONE)},
                                        {EACCES, io | LIFE_STATUS(HAL_ERROR_DENIED)},
                                        {EBUSY, io | LIFE_STATUS(HAL_ERROR_DENIED)}};
    linux_gpio_close(&gpio);
    lives_each_failure(&(struct lives){.device = chip,
                                       .live = live,
                                       .errors = errors,
                                       .error_count = 4,
                                       .share_out = true,
                                       .stride = LIVES_VM_STRIDE,
                                       .recover_every = 4,
                                       .dies = true});
}

static void lines_fail_at_every_step(void) {
    each_failure(live_with_lines, 0);
}

static void pulses_fail_at_every_step(void) {
    each_failure(live_with_pulses, LIFE_STATUS(HAL_ERROR_GONE));
}

static void steps_fail_at_every_step(void) {
    each_failure(live_with_steps, LIFE_STATUS(HAL_ERROR_GONE));
}

/// The chip's file is root's.
static void forbidden(void) {
    static struct linux_gpio_pulses pulses;
    static struct linux_gpio_steps steps;
    static const uint32_t channels[] = {9};
    char line[LINUX_ERROR_BYTES];
    bool active;
    linux_gpio_close(&gpio);
    shell("chmod 600 /dev/%s", chip);
    snprintf(line, sizeof line,
             "/dev/%s: no permission; its mode is 600 and no group is let in: ", chip);
    nobody_begin();
    CHECK_EQ(linux_gpio_open(&gpio, gpio_suite_lines, pins, 1), HAL_ERROR_DENIED);
    if (!CHECK(strncmp(gpio.error.line, line, strlen(line)) == 0)) {
        printf("  %s\n", gpio.error.line);
    }
    CHECK_EQ(hal_gpio_read(&gpio.hal, 0, &active), HAL_ERROR_GONE);
    CHECK_EQ(linux_gpio_pulses_open(&pulses, chip, channels, 1), HAL_ERROR_DENIED);
    CHECK(strncmp(pulses.error.line, line, strlen(line)) == 0);
    CHECK_EQ(linux_gpio_steps_open(&steps, chip, 11, 12, 1000, 0), HAL_ERROR_DENIED);
    CHECK(strncmp(steps.error.line, line, strlen(line)) == 0);
    nobody_end();
}

int main(void) {
    sim_gpio_create(16, chip, sizeof chip);
    for (uint32_t i = 0; i < GPIO_SUITE_LINES; i++) {
        pins[i] = (struct linux_gpio_pin){chip, (i * 5U + 2U) % 16U}; // in no order
    }
    if (linux_gpio_library() == NULL) {
        contract_skip("linux_gpio", "all", "built without libgpiod");
        return 0;
    }
    reset(NULL);
    gpio_suite(&(struct gpio_fixture){.name = "linux_gpio",
                                      .gpio = &gpio.hal,
                                      .lines = gpio_suite_lines,
                                      .line_count = GPIO_SUITE_LINES,
                                      .reset = reset,
                                      .fail_at = fail_at,
                                      .drive = drive,
                                      .is_high = is_high});
    CONTRACT("linux_gpio", refusals_say_what_to_do);
    CONTRACT("linux_gpio", lines_are_given_back);
    CONTRACT("linux_gpio", chips_have_two_names);
    CONTRACT("linux_gpio", pulses_come_out);
    CONTRACT("linux_gpio", steps_come_out);
    CONTRACT("linux_gpio", chip_leaves_and_returns);
    CONTRACT("linux_gpio", lines_fail_at_every_step);
    CONTRACT("linux_gpio", pulses_fail_at_every_step);
    CONTRACT("linux_gpio", steps_fail_at_every_step);
    CONTRACT("linux_gpio", forbidden);
    linux_gpio_close(&gpio);
    sim_gpio_remove();
    return check_finish();
}

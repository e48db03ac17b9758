/// The GPIO driver on a bank of the kernel's gpio-sim, whose far side is in sysfs.
#include "linux/linux_gpio.h"
#include "contract/support/contract.h"
#include "contract/support/gpio_suite.h"
#include "vm/support/shell.h"
#include "vm/support/sim_gpio.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct linux_gpio gpio;
static struct linux_gpio_pin pins[GPIO_SUITE_LINES];
static char chip[32]; ///< gpiochipN

static void reset(void *context) {
    (void)context;
    linux_gpio_close(&gpio);
    if (!CHECK_EQ(linux_gpio_open(&gpio, gpio_suite_lines, pins, GPIO_SUITE_LINES), HAL_OK)) {
        printf("  %s\n", gpio.error.line);
    }
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
                                      .drive = drive,
                                      .is_high = is_high});
    CONTRACT("linux_gpio", refusals_say_what_to_do);
    CONTRACT("linux_gpio", lines_are_given_back);
    CONTRACT("linux_gpio", chips_have_two_names);
    linux_gpio_close(&gpio);
    sim_gpio_remove();
    return check_finish();
}

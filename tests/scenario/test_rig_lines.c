/// Reading lines from a rig file, and debouncing.
#include "rig_lines.h"

#include "check.h"

#include <string.h>

static void texts_that_are_lines(void) {
    static const struct {
        const char *text, *chip;
        uint32_t number;
        bool low;
        enum hal_gpio_pull pull;
    } cases[] = {{"gpiochip0:17", "gpiochip0", 17, false, HAL_GPIO_PULL_NONE},
                 {"gpiochip0:0:up", "gpiochip0", 0, false, HAL_GPIO_PULL_UP},
                 {"pinctrl-bcm2711:4:low:down", "pinctrl-bcm2711", 4, true, HAL_GPIO_PULL_DOWN},
                 {"/dev/gpiochip1:53:up:low", "/dev/gpiochip1", 53, true, HAL_GPIO_PULL_UP}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char chip[64];
        uint32_t number;
        struct hal_gpio_line line = {.direction = HAL_GPIO_INPUT};
        CHECK(rig_line_parse(cases[i].text, chip, &number, &line));
        CHECK(strcmp(chip, cases[i].chip) == 0);
        CHECK_EQ(number, cases[i].number);
        CHECK_EQ(line.active_low, cases[i].low);
        CHECK_EQ(line.pull, cases[i].pull);
    }
}

static void texts_that_are_none(void) {
    static const char *const bad[] = {
        "",     "17",   "gpiochip0", ":17",       "gpiochip0:", "a:x",
        "a:1x", "a:1:", "a:1:high",  "a:1:lowup", "a:1:up:ox",  "a:4096",
        "a:-1", "a: 1", "a:1 :up",   "a:+1",      "a:1:UP",     "a:99999999999999999999"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char chip[64];
        uint32_t number;
        struct hal_gpio_line line = {.direction = HAL_GPIO_INPUT};
        CHECK(!rig_line_parse(bad[i], chip, &number, &line));
    }
}

/// A contact that bounces for 3 ms, each reading written out; 5 ms are asked for.
static void bounces_are_no_presses(void) {
    static const char readings[] = "0010110111111111110100101000000000";
    static const char debounced[] = "0000000000001111111111111111110000";
    struct debounce debounce = {0};
    uint32_t presses = 0;
    for (uint64_t ms = 0; readings[ms] != '\0'; ms++) {
        presses += debounce_update(&debounce, readings[ms] == '1', ms * 1000U, 5000, 5000);
        CHECK_EQ(debounce.active, debounced[ms] == '1');
    }
    CHECK_EQ(presses, 1);
}

/// The emergency stop: pressed at once, released after the time.
static void stop_is_pressed_at_once(void) {
    static const char readings[] = "01010000000100000000";
    static const char debounced[] = "01111111100111111000";
    struct debounce debounce = {0};
    uint32_t presses = 0;
    for (uint64_t ms = 0; readings[ms] != '\0'; ms++) {
        presses += debounce_update(&debounce, readings[ms] == '1', ms * 1000U, 0, 5000);
        CHECK_EQ(debounce.active, debounced[ms] == '1');
    }
    CHECK_EQ(presses, 2);
}

int main(void) {
    TEST(texts_that_are_lines);
    TEST(texts_that_are_none);
    TEST(bounces_are_no_presses);
    TEST(stop_is_pressed_at_once);
    return check_finish();
}

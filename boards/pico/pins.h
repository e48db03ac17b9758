/// What is wired where; README.md has the same as a table for a person with a soldering iron.
#ifndef PICO_PINS_H
#define PICO_PINS_H

#include "hal/gpio.h"

#define CONSOLE_BAUD 115200U
enum { CONSOLE_TX = 0, CONSOLE_RX = 1 };

/// Servo outputs by number: `channel` in a rig file. Pairs share a period.
static const uint8_t pwm_pins[] = {2, 3, 4, 5, 6, 7};

/// Lines by number. Switches are closed to ground and open when pressed, so that a broken wire
/// stops, too.
enum { LINE_EMERGENCY_STOP, LINE_KEY_SWITCH, LINE_PAN_LIMIT, LINE_TILT_LIMIT, LINE_ENABLE };

#define SWITCH                                                                                     \
    { .direction = HAL_GPIO_INPUT, .pull = HAL_GPIO_PULL_UP, .active_low = false }
static const struct hal_gpio_line gpio_lines[] = {
    [LINE_EMERGENCY_STOP] = SWITCH,
    [LINE_KEY_SWITCH] = SWITCH,
    [LINE_PAN_LIMIT] = SWITCH,
    [LINE_TILT_LIMIT] = SWITCH,
    [LINE_ENABLE] = {.direction = HAL_GPIO_OUTPUT, .pull = HAL_GPIO_PULL_NONE},
};
static const uint8_t gpio_pins[] = {
    [LINE_EMERGENCY_STOP] = 10, [LINE_KEY_SWITCH] = 11, [LINE_PAN_LIMIT] = 12,
    [LINE_TILT_LIMIT] = 13,     [LINE_ENABLE] = 14,
};

#endif

/// The digital lines that every board has, by number; which pin each one is stands in the board's
/// pins.h.
#ifndef BOARDS_SWITCHES_H
#define BOARDS_SWITCHES_H

#include "app/board_loop.h"
#include "hal/gpio.h"

/// Switches are closed to ground and open when pressed, so that a broken wire
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

/// What stops the gimbal, and how the console names it.
static const struct board_stop_line stop_lines[] = {
    {LINE_EMERGENCY_STOP, "emergency stop"},
    {LINE_KEY_SWITCH, "key switch off"},
    {LINE_PAN_LIMIT, "pan limit switch"},
    {LINE_TILT_LIMIT, "tilt limit switch"},
};

#endif

/// What is wired where; README.md has the same as a table for a person with a soldering iron.
#ifndef PICO_PINS_H
#define PICO_PINS_H

#include "switches.h"

#include <stdint.h>

#define CONSOLE_BAUD 115200U
enum { CONSOLE_TX = 0, CONSOLE_RX = 1 };

/// Servo outputs by number: `channel` in a rig file. Pairs share a period.
static const uint8_t pwm_pins[] = {2, 3, 4, 5, 6, 7};

/// By number (switches.h).
static const uint8_t gpio_pins[] = {
    [LINE_EMERGENCY_STOP] = 10, [LINE_KEY_SWITCH] = 11, [LINE_PAN_LIMIT] = 12,
    [LINE_TILT_LIMIT] = 13,     [LINE_ENABLE] = 14,
};

#endif

/// Numbered lines in memory, with a pin each that tests and plants can drive and look at.
#ifndef DEVICES_FAKE_GPIO_H
#define DEVICES_FAKE_GPIO_H

#include "devices/fake_failures.h"
#include "hal/gpio.h"

#define FAKE_GPIO_LINES_MAX 32U

struct fake_gpio {
    struct hal_gpio hal;
    struct fake_failures failures;
    const struct hal_gpio_line *lines;
    uint32_t line_count;
    /// The level of each pin, one bit a line.
    uint32_t high_bits;
};

/// Must not move in memory afterwards. lines: the table, line_count rows (at most
/// FAKE_GPIO_LINES_MAX); stays the caller's. Nothing is connected: inputs are where their resistors
/// pull them, without one low.
void fake_gpio_init(struct fake_gpio *gpio, const struct hal_gpio_line *lines, uint32_t line_count);

/// Puts an input's pin at a level. line: less than line_count.
void fake_gpio_drive(struct fake_gpio *gpio, uint32_t line, bool high);
/// Lets go of it again.
void fake_gpio_release(struct fake_gpio *gpio, uint32_t line);
/// The level at a pin.
bool fake_gpio_is_high(const struct fake_gpio *gpio, uint32_t line);

#endif

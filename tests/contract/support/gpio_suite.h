/// The contract of hal/gpio.h as a test.
#ifndef CONTRACT_SUPPORT_GPIO_SUITE_H
#define CONTRACT_SUPPORT_GPIO_SUITE_H

#include "hal/gpio.h"

/// Every kind of line there is: a table to open a device with that can have any.
enum { GPIO_SUITE_LINES = 8 };
extern const struct hal_gpio_line gpio_suite_lines[GPIO_SUITE_LINES];

struct gpio_fixture {
    const char *name;
    const struct hal_gpio *gpio;
    /// The table that the device was opened with. The suite is worth most with at least two inputs
    /// and two outputs, active low and active high of each.
    const struct hal_gpio_line *lines;
    uint32_t line_count;
    void *context;
    /// As after power-on; nothing is connected; no failure pending.
    void (*reset)(void *context);
    /// Puts an input's pin at a level.
    void (*drive)(void *context, uint32_t line, bool high);
    /// The level at a pin.
    bool (*is_high)(void *context, uint32_t line);
    /// See contract.h.
    bool (*fail_at)(void *context, uint32_t nth, enum hal_status status);
};

void gpio_suite(const struct gpio_fixture *fixture);

#endif

/// Pins, and the lines of hal/gpio.h on them. A pin is its number: GP25 is 25.
/// Shown: tests/mcu/rp2040/pico.sh.
#ifndef RP2040_RP2040_GPIO_H
#define RP2040_RP2040_GPIO_H

#include "hal/gpio.h"

/// A pin for each row of lines.
struct rp2040_gpio {
    struct hal_gpio hal;
    const struct hal_gpio_line *lines;
    const uint8_t *pins;
    uint32_t line_count;
};

/// Sets the pins up as the tables say: outputs have their first level before they are driven.
void rp2040_gpio_init(struct rp2040_gpio *gpio, const struct hal_gpio_line *lines,
                      const uint8_t *pins, uint32_t line_count);

/// Hands a pin to a peripheral. function: 2.19.2, RP2040_FUNCTION_*.
void rp2040_gpio_set_function(uint8_t pin, uint32_t function, enum hal_gpio_pull pull);

#endif

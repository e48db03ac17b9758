/// Pins, and the lines of hal/gpio.h on them.
/// Shown: tests/mcu/hal/suites.c.
#ifndef STM32F4_STM32F4_GPIO_H
#define STM32F4_STM32F4_GPIO_H

#include "hal/gpio.h"

/// PB8 is {1, 8}.
struct stm32f4_pin {
    uint8_t port;
    uint8_t bit;
};

/// A row for each row of lines.
struct stm32f4_gpio {
    struct hal_gpio hal;
    const struct hal_gpio_line *lines;
    const struct stm32f4_pin *pins;
    uint32_t line_count;
};

/// Sets the pins up as the tables say: outputs have their first level before they are driven.
void stm32f4_gpio_init(struct stm32f4_gpio *gpio, const struct hal_gpio_line *lines,
                       const struct stm32f4_pin *pins, uint32_t line_count);

/// Hands a pin to a peripheral, with or without a pull-up.
/// alternate: number of the function, from the data sheet's table of pins.
void stm32f4_gpio_set_alternate(struct stm32f4_pin pin, unsigned alternate,
                                enum hal_gpio_pull pull);

#endif

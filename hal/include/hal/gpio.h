/// Numbered lines: limit switches, enable lines, the emergency stop.
///
/// A table says what each line is; its index is the line's number. Levels are logical: active or
/// not. Wire a switch normally closed with a pull-up and active_low = false (active = open): a
/// broken wire then reads as a pressed switch.
/// Shown: tests/contract/support/gpio_suite.h, on every implementation.
#ifndef HAL_GPIO_H
#define HAL_GPIO_H

#include "fixed/must_check.h"
#include "hal/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum hal_gpio_direction { HAL_GPIO_INPUT, HAL_GPIO_OUTPUT };
enum hal_gpio_pull { HAL_GPIO_PULL_NONE, HAL_GPIO_PULL_UP, HAL_GPIO_PULL_DOWN };

/// One row of the table; the driver's own table beside it says which pin that is.
struct hal_gpio_line {
    enum hal_gpio_direction direction;
    enum hal_gpio_pull pull;
    /// Active is the low level.
    bool active_low;
    /// Outputs: set before the pin is driven for the first time.
    bool initially_active;
};

struct hal_gpio_ops {
    enum hal_status (*read)(void *ctx, uint32_t line, bool *active);
    enum hal_status (*write)(void *ctx, uint32_t line, bool active);
};

struct hal_gpio {
    const struct hal_gpio_ops *ops;
    void *ctx;
};

/// Fills *gpio. HAL_ERROR_ARGUMENT (and *gpio as it was) if anything but ctx is null.
MUST_CHECK static inline enum hal_status hal_gpio_bind(struct hal_gpio *gpio,
                                                       const struct hal_gpio_ops *ops, void *ctx) {
    if (gpio == NULL || ops == NULL || ops->read == NULL || ops->write == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    *gpio = (struct hal_gpio){ops, ctx};
    return HAL_OK;
}

/// The level of a line now; of an output, the level at the pin. Not debounced.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: no such line; HAL_ERROR_IO, HAL_ERROR_GONE.
///           *active is set with HAL_OK only: of a switch that can't be read assume the worst.
/// Cost:     a register read; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_gpio_read(const struct hal_gpio *gpio, uint32_t line,
                                                       bool *active) {
    if (active == NULL) {
        return HAL_ERROR_ARGUMENT;
    }
    return gpio->ops->read(gpio->ctx, line, active);
}

/// Sets an output; it has the level when the call returns.
/// Returns:  HAL_OK; HAL_ERROR_ARGUMENT: no such line, or an input; HAL_ERROR_IO, HAL_ERROR_GONE:
///           the line may have either level.
/// Cost:     a register write; on Linux one system call.
MUST_CHECK static inline enum hal_status hal_gpio_write(const struct hal_gpio *gpio, uint32_t line,
                                                        bool active) {
    return gpio->ops->write(gpio->ctx, line, active);
}

#endif

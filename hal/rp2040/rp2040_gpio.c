#include "rp2040/rp2040_gpio.h"

#include "rp2040/rp2040_registers.h"

static uint32_t pull_bits(enum hal_gpio_pull pull) {
    return pull == HAL_GPIO_PULL_UP     ? RP2040_PAD_PULL_UP
           : pull == HAL_GPIO_PULL_DOWN ? RP2040_PAD_PULL_DOWN
                                        : 0U;
}

/// The function comes last: until then nothing drives the pin.
void rp2040_gpio_set_function(uint8_t pin, uint32_t function, enum hal_gpio_pull pull) {
    RP2040_PIN_PAD[pin] =
        RP2040_PAD_INPUT_ENABLE | RP2040_PAD_DRIVE_4MA | RP2040_PAD_SCHMITT | pull_bits(pull);
    RP2040_PIN_FUNCTION[pin].control = function;
}

static void put(uint8_t pin, bool high) {
    if (high) {
        RP2040_SIO->out_set = UINT32_C(1) << pin;
    } else {
        RP2040_SIO->out_clear = UINT32_C(1) << pin;
    }
}

static enum hal_status gpio_read(void *ctx, uint32_t line, bool *active) {
    const struct rp2040_gpio *gpio = ctx;
    if (line >= gpio->line_count) {
        return HAL_ERROR_ARGUMENT;
    }
    const bool high = (RP2040_SIO->in >> gpio->pins[line] & 1U) != 0U;
    *active = high != gpio->lines[line].active_low;
    return HAL_OK;
}

static enum hal_status gpio_write(void *ctx, uint32_t line, bool active) {
    const struct rp2040_gpio *gpio = ctx;
    if (line >= gpio->line_count || gpio->lines[line].direction != HAL_GPIO_OUTPUT) {
        return HAL_ERROR_ARGUMENT;
    }
    put(gpio->pins[line], active != gpio->lines[line].active_low);
    return HAL_OK;
}

static const struct hal_gpio_ops rp2040_gpio_ops = {gpio_read, gpio_write};

void rp2040_gpio_init(struct rp2040_gpio *gpio, const struct hal_gpio_line *lines,
                      const uint8_t *pins, uint32_t line_count) {
    *gpio = (struct rp2040_gpio){{&rp2040_gpio_ops, gpio}, lines, pins, line_count};
    for (uint32_t line = 0; line < line_count; line++) {
        const uint32_t bit = UINT32_C(1) << pins[line];
        if (lines[line].direction == HAL_GPIO_OUTPUT) {
            put(pins[line], lines[line].initially_active != lines[line].active_low);
            RP2040_SIO->enable_set = bit;
        } else {
            RP2040_SIO->enable_clear = bit;
        }
        rp2040_gpio_set_function(pins[line], RP2040_FUNCTION_SIO, lines[line].pull);
    }
}

#include "devices/fake_gpio.h"

#include "devices/fake_bind.h"

static void set_pin(struct fake_gpio *gpio, uint32_t line, bool high) {
    const uint32_t bit = UINT32_C(1) << line;
    gpio->high_bits = high ? gpio->high_bits | bit : gpio->high_bits & ~bit;
}

static enum hal_status fake_gpio_read(void *ctx, uint32_t line, bool *active) {
    struct fake_gpio *gpio = ctx;
    if (line >= gpio->line_count) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = fake_failures_call(&gpio->failures);
    if (status == HAL_OK) {
        *active = fake_gpio_is_high(gpio, line) != gpio->lines[line].active_low;
    }
    return status;
}

static enum hal_status fake_gpio_write(void *ctx, uint32_t line, bool active) {
    struct fake_gpio *gpio = ctx;
    if (line >= gpio->line_count || gpio->lines[line].direction != HAL_GPIO_OUTPUT) {
        return HAL_ERROR_ARGUMENT;
    }
    const enum hal_status status = fake_failures_call(&gpio->failures);
    if (status == HAL_OK) {
        set_pin(gpio, line, active != gpio->lines[line].active_low);
    }
    return status;
}

static const struct hal_gpio_ops ops = {fake_gpio_read, fake_gpio_write};

void fake_gpio_init(struct fake_gpio *gpio, const struct hal_gpio_line *lines,
                    uint32_t line_count) {
    *gpio = (struct fake_gpio){.lines = lines, .line_count = line_count};
    if (line_count > FAKE_GPIO_LINES_MAX) {
        abort();
    }
    for (uint32_t i = 0; i < line_count; i++) {
        if (lines[i].direction == HAL_GPIO_OUTPUT) {
            set_pin(gpio, i, lines[i].initially_active != lines[i].active_low);
        } else {
            fake_gpio_release(gpio, i);
        }
    }
    fake_bind_check(hal_gpio_bind(&gpio->hal, &ops, gpio));
}

void fake_gpio_drive(struct fake_gpio *gpio, uint32_t line, bool high) {
    if (gpio->lines[line].direction == HAL_GPIO_INPUT) {
        set_pin(gpio, line, high);
    }
}

void fake_gpio_release(struct fake_gpio *gpio, uint32_t line) {
    fake_gpio_drive(gpio, line, gpio->lines[line].pull == HAL_GPIO_PULL_UP);
}

bool fake_gpio_is_high(const struct fake_gpio *gpio, uint32_t line) {
    return (gpio->high_bits >> line & 1U) != 0U;
}

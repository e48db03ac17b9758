#include "stm32f4/stm32f4_gpio.h"

#include "stm32f4/stm32f4_clocks.h"
#include "stm32f4/stm32f4_registers.h"

enum { MODE_INPUT, MODE_OUTPUT, MODE_ALTERNATE };

static void set_field(volatile uint32_t *reg, unsigned bits, unsigned index, uint32_t value) {
    const unsigned shift = index * bits;
    *reg = (*reg & ~(((1U << bits) - 1U) << shift)) | value << shift;
}

static uint32_t pull_code(enum hal_gpio_pull pull) {
    return pull == HAL_GPIO_PULL_UP ? 1U : pull == HAL_GPIO_PULL_DOWN ? 2U : 0U;
}

/// The mode comes last: until then the pin is as it was.
static void set_up(struct stm32f4_pin pin, uint32_t mode, enum hal_gpio_pull pull) {
    struct stm32f4_gpio_port *port = STM32F4_GPIO_PORT(pin.port);
    set_field(&port->pupdr, 2, pin.bit, pull_code(pull));
    set_field(&port->ospeedr, 2, pin.bit, 1); // medium: 25 MHz and less noise than fast
    set_field(&port->moder, 2, pin.bit, mode);
}

static void put(struct stm32f4_pin pin, bool high) {
    STM32F4_GPIO_PORT(pin.port)->bsrr = 1U << (high ? pin.bit : pin.bit + 16U);
}

static enum hal_status gpio_read(void *ctx, uint32_t line, bool *active) {
    const struct stm32f4_gpio *gpio = ctx;
    if (line >= gpio->line_count) {
        return HAL_ERROR_ARGUMENT;
    }
    const struct stm32f4_pin pin = gpio->pins[line];
    const bool high = (STM32F4_GPIO_PORT(pin.port)->idr >> pin.bit & 1U) != 0U;
    *active = high != gpio->lines[line].active_low;
    return HAL_OK;
}

static enum hal_status gpio_write(void *ctx, uint32_t line, bool active) {
    const struct stm32f4_gpio *gpio = ctx;
    if (line >= gpio->line_count || gpio->lines[line].direction != HAL_GPIO_OUTPUT) {
        return HAL_ERROR_ARGUMENT;
    }
    put(gpio->pins[line], active != gpio->lines[line].active_low);
    return HAL_OK;
}

static const struct hal_gpio_ops stm32f4_gpio_ops = {gpio_read, gpio_write};

void stm32f4_gpio_init(struct stm32f4_gpio *gpio, const struct hal_gpio_line *lines,
                       const struct stm32f4_pin *pins, uint32_t line_count) {
    (void)!hal_gpio_bind(&gpio->hal, &stm32f4_gpio_ops, gpio);
    gpio->lines = lines;
    gpio->pins = pins;
    gpio->line_count = line_count;
    for (uint32_t line = 0; line < line_count; line++) {
        stm32f4_clocks_enable(STM32F4_GPIO_PORT(pins[line].port));
        const bool output = lines[line].direction == HAL_GPIO_OUTPUT;
        if (output) {
            put(pins[line], lines[line].initially_active != lines[line].active_low);
        }
        set_up(pins[line], output ? MODE_OUTPUT : MODE_INPUT, lines[line].pull);
    }
}

void stm32f4_gpio_set_alternate(struct stm32f4_pin pin, unsigned alternate,
                                enum hal_gpio_pull pull) {
    struct stm32f4_gpio_port *port = STM32F4_GPIO_PORT(pin.port);
    stm32f4_clocks_enable(port);
    set_field(&port->afr[pin.bit / 8U], 4, pin.bit % 8U, alternate);
    set_up(pin, MODE_ALTERNATE, pull);
}

#include "mcu/gpio.h"

#include "mcu/soc.h"

#define MODE_INPUT     0U
#define MODE_OUTPUT    1U
#define MODE_ALTERNATE 2U
#define LCKK           (UINT32_C(1) << 16)

// ---------------------------------------------------------------- alternate functions

struct alternate {
    uint8_t pin, function;
    struct gpio_function to;
};

#define TIM(port, number, af, timer, channel)                                                      \
    {                                                                                              \
        GPIO_PIN(port, number), af, {                                                              \
            GPIO_SIGNAL_TIMER, (timer)-1, (channel)-1                                              \
        }                                                                                          \
    }
#define TX(port, number, af, usart)                                                                \
    {                                                                                              \
        GPIO_PIN(port, number), af, {                                                              \
            GPIO_SIGNAL_USART_TX, (usart)-1, 0                                                     \
        }                                                                                          \
    }
#define RX(port, number, af, usart)                                                                \
    {                                                                                              \
        GPIO_PIN(port, number), af, {                                                              \
            GPIO_SIGNAL_USART_RX, (usart)-1, 0                                                     \
        }                                                                                          \
    }
#define CAN(port, number, direction, can)                                                          \
    {                                                                                              \
        GPIO_PIN(port, number), 9, {                                                               \
            GPIO_SIGNAL_CAN_##direction, (can)-1, 0                                                \
        }                                                                                          \
    }

static const struct alternate alternates[] = {
    TIM('A', 8, 1, 1, 1),  TIM('A', 9, 1, 1, 2),  TIM('A', 10, 1, 1, 3), TIM('A', 11, 1, 1, 4),
    TIM('E', 9, 1, 1, 1),  TIM('E', 11, 1, 1, 2), TIM('E', 13, 1, 1, 3), TIM('E', 14, 1, 1, 4),
    TIM('A', 0, 1, 2, 1),  TIM('A', 5, 1, 2, 1),  TIM('A', 15, 1, 2, 1), TIM('A', 1, 1, 2, 2),
    TIM('B', 3, 1, 2, 2),  TIM('A', 2, 1, 2, 3),  TIM('B', 10, 1, 2, 3), TIM('A', 3, 1, 2, 4),
    TIM('B', 11, 1, 2, 4), TIM('A', 6, 2, 3, 1),  TIM('B', 4, 2, 3, 1),  TIM('C', 6, 2, 3, 1),
    TIM('A', 7, 2, 3, 2),  TIM('B', 5, 2, 3, 2),  TIM('C', 7, 2, 3, 2),  TIM('B', 0, 2, 3, 3),
    TIM('C', 8, 2, 3, 3),  TIM('B', 1, 2, 3, 4),  TIM('C', 9, 2, 3, 4),  TIM('B', 6, 2, 4, 1),
    TIM('D', 12, 2, 4, 1), TIM('B', 7, 2, 4, 2),  TIM('D', 13, 2, 4, 2), TIM('B', 8, 2, 4, 3),
    TIM('D', 14, 2, 4, 3), TIM('B', 9, 2, 4, 4),  TIM('D', 15, 2, 4, 4), TIM('A', 0, 2, 5, 1),
    TIM('A', 1, 2, 5, 2),  TIM('A', 2, 2, 5, 3),  TIM('A', 3, 2, 5, 4),  TX('A', 9, 7, 1),
    TX('B', 6, 7, 1),      RX('A', 10, 7, 1),     RX('B', 7, 7, 1),      TX('A', 2, 7, 2),
    TX('D', 5, 7, 2),      RX('A', 3, 7, 2),      RX('D', 6, 7, 2),      TX('B', 10, 7, 3),
    TX('C', 10, 7, 3),     TX('D', 8, 7, 3),      RX('B', 11, 7, 3),     RX('C', 11, 7, 3),
    RX('D', 9, 7, 3),      TX('A', 0, 8, 4),      TX('C', 10, 8, 4),     RX('A', 1, 8, 4),
    RX('C', 11, 8, 4),     TX('C', 12, 8, 5),     RX('D', 2, 8, 5),      TX('C', 6, 8, 6),
    TX('G', 14, 8, 6),     RX('C', 7, 8, 6),      RX('G', 9, 8, 6),      CAN('A', 12, TX, 1),
    CAN('B', 9, TX, 1),    CAN('D', 1, TX, 1),    CAN('A', 11, RX, 1),   CAN('B', 8, RX, 1),
    CAN('D', 0, RX, 1),    CAN('B', 6, TX, 2),    CAN('B', 13, TX, 2),   CAN('B', 5, RX, 2),
    CAN('B', 12, RX, 2),
};

static unsigned mode_of(const struct gpio_port *port, unsigned number) {
    return port->moder >> (2U * number) & 3U;
}

/// Looks up what every pin of a port is connected to.
static void connect(struct gpio_port *port) {
    for (unsigned i = 0; i < GPIO_PINS_PER_PORT; i++) {
        const unsigned pin = 16U * port->index + i;
        const unsigned selected = port->afr[i / 8U] >> (4U * (i % 8U)) & 15U;
        port->connection[i] = (struct gpio_function){GPIO_SIGNAL_NONE, 0, 0};
        for (unsigned k = 0; k < sizeof alternates / sizeof *alternates; k++) {
            if (mode_of(port, i) == MODE_ALTERNATE && alternates[k].pin == pin &&
                alternates[k].function == selected) {
                port->connection[i] = alternates[k].to;
            }
        }
    }
}

struct gpio_function gpio_connection(const struct soc *soc, unsigned pin) {
    return soc->gpio[pin / 16U].connection[pin % 16U];
}

bool gpio_is_connected(const struct soc *soc, unsigned pin, enum gpio_signal signal,
                       unsigned part) {
    const struct gpio_function function = gpio_connection(soc, pin);
    return function.signal == signal && function.part == part;
}

// ---------------------------------------------------------------- levels

/// Levels of a port's pins.
static uint32_t levels(const struct gpio_port *port) {
    uint32_t value = 0;
    for (unsigned i = 0; i < GPIO_PINS_PER_PORT; i++) {
        const uint32_t bit = UINT32_C(1) << i;
        const bool open_drain = (port->otyper & bit) != 0U;
        bool high;
        if (mode_of(port, i) == MODE_OUTPUT && (!open_drain || (port->odr & bit) == 0U)) {
            high = (port->odr & bit) != 0U;
        } else if ((port->driven & bit) != 0U) {
            high = (port->driven_high & bit) != 0U;
        } else {
            high = (port->pupdr >> (2U * i) & 3U) == 1U;
        }
        value |= high ? bit : 0U;
    }
    return value;
}

bool gpio_level(const struct soc *soc, unsigned pin) {
    return (levels(&soc->gpio[pin / 16U]) >> (pin % 16U) & 1U) != 0U;
}

enum gpio_drive gpio_output(const struct soc *soc, unsigned pin) {
    const struct gpio_port *port = &soc->gpio[pin / 16U];
    const bool high = (port->odr >> (pin % 16U) & 1U) != 0U;
    const bool open_drain = (port->otyper >> (pin % 16U) & 1U) != 0U;
    if (mode_of(port, pin % 16U) != MODE_OUTPUT || (open_drain && high)) {
        return GPIO_FLOATING;
    }
    return high ? GPIO_HIGH : GPIO_LOW;
}

void gpio_drive(struct soc *soc, unsigned pin, enum gpio_drive drive) {
    struct gpio_port *port = &soc->gpio[pin / 16U];
    const uint16_t bit = (uint16_t)(1U << (pin % 16U));
    const uint32_t before = levels(port);
    port->driven = (uint16_t)(drive != GPIO_FLOATING ? port->driven | bit : port->driven & ~bit);
    port->driven_high =
        (uint16_t)(drive == GPIO_HIGH ? port->driven_high | bit : port->driven_high & ~bit);
    exti_port_changed(&soc->exti, port->index, before, levels(port));
}

// ---------------------------------------------------------------- registers

void gpio_reset(struct gpio_port *port, struct soc *soc, unsigned index) {
    // The debug port's pins are not inputs after reset: PA13 to PA15, PB3 and PB4.
    *port = (struct gpio_port){.soc = soc,
                               .index = (uint8_t)index,
                               .moder = index == 0U   ? 0xA8000000U
                                        : index == 1U ? 0x00000280U
                                                      : 0U,
                               .ospeedr = index == 0U   ? 0x0C000000U
                                          : index == 1U ? 0x000000C0U
                                                        : 0U,
                               .pupdr = index == 0U   ? 0x64000000U
                                        : index == 1U ? 0x00000100U
                                                      : 0U,
                               .driven = port->driven,
                               .driven_high = port->driven_high};
    connect(port);
}

uint32_t gpio_read(void *model, uint32_t offset) {
    const struct gpio_port *port = model;
    switch (offset) {
    case 0x00:
        return port->moder;
    case 0x04:
        return port->otyper;
    case 0x08:
        return port->ospeedr;
    case 0x0C:
        return port->pupdr;
    case 0x10:
        return levels(port);
    case 0x14:
        return port->odr;
    case 0x1C:
        return port->lckr | (port->locked ? LCKK : 0U);
    case 0x20:
        return port->afr[0];
    case 0x24:
        return port->afr[1];
    default:
        return 0; // BSRR can only be written
    }
}

/// A bit of LCKR that is set, stretched to fields of `width` bits. Only once the lock is closed.
static uint32_t frozen(const struct gpio_port *port, unsigned first, unsigned count,
                       unsigned width) {
    uint32_t mask = 0;
    for (unsigned i = 0; port->locked && i < count; i++) {
        if ((port->lckr >> (first + i) & 1U) != 0U) {
            mask |= ((UINT32_C(1) << width) - 1U) << (i * width);
        }
    }
    return mask;
}

static void write_field(uint32_t *reg, uint32_t value, uint32_t lanes, uint32_t frozen_bits) {
    const uint32_t changed = lanes & ~frozen_bits;
    *reg = (*reg & ~changed) | (value & changed);
}

/// The lock closes after the sequence: 1, 0, 1 in LCKK with the same pins, then a read.
static void write_lock(struct gpio_port *port, uint32_t value) {
    const uint32_t pins = value & 0xFFFFU;
    const bool key = (value & LCKK) != 0U;
    if (port->locked) {
        return;
    }
    const bool goes_on =
        port->lock_step != 0U && pins == port->lckr && key == (port->lock_step == 2U);
    port->lock_step = goes_on ? (uint8_t)(port->lock_step + 1U) : key ? 1U : 0U;
    port->lckr = pins;
    port->locked = port->lock_step == 3U;
}

void gpio_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct gpio_port *port = model;
    const uint32_t before = levels(port);
    switch (offset) {
    case 0x00:
        write_field(&port->moder, value, lanes, frozen(port, 0, 16, 2));
        connect(port);
        break;
    case 0x04:
        write_field(&port->otyper, value, lanes & 0xFFFFU, frozen(port, 0, 16, 1));
        break;
    case 0x08:
        write_field(&port->ospeedr, value, lanes, frozen(port, 0, 16, 2));
        break;
    case 0x0C:
        write_field(&port->pupdr, value, lanes, frozen(port, 0, 16, 2));
        break;
    case 0x14:
        write_field(&port->odr, value, lanes & 0xFFFFU, 0);
        break;
    case 0x18: // the lower half sets, and wins over the upper one, which resets
        value &= lanes;
        port->odr = (port->odr & ~(value >> 16)) | (value & 0xFFFFU);
        break;
    case 0x1C:
        write_lock(port, value);
        break;
    case 0x20:
        write_field(&port->afr[0], value, lanes, frozen(port, 0, 8, 4));
        connect(port);
        break;
    case 0x24:
        write_field(&port->afr[1], value, lanes, frozen(port, 8, 8, 4));
        connect(port);
        break;
    default:
        break;
    }
    exti_port_changed(&port->soc->exti, port->index, before, levels(port));
}

/// General-purpose pins and which part each is connected to.
///
/// Source: RM0090, chapter 8; the table of alternate functions: STM32F405xx data sheet, table 9, as
/// far as parts with a model go. A pin outside the chip is driven high, low or not at all by the
/// world (gpio_drive); an input that nobody drives follows its pull resistor, and reads 0 without
/// one. Left out: analog functions, speeds (kept), delays. Shown: tests/mcu/gpio.c.
#ifndef MCU_GPIO_H
#define MCU_GPIO_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

enum { GPIO_PORTS = 9, GPIO_PINS_PER_PORT = 16 };

/// A pin as one number: GPIO_PIN('B', 8).
#define GPIO_PIN(port, number) ((unsigned)((port) - 'A') * 16U + (unsigned)(number))

enum gpio_drive { GPIO_FLOATING, GPIO_LOW, GPIO_HIGH };

/// What an alternate function connects a pin to.
enum gpio_signal {
    GPIO_SIGNAL_NONE,
    GPIO_SIGNAL_TIMER,    ///< part: 0 is TIM1; channel 0 to 3
    GPIO_SIGNAL_USART_TX, ///< part: 0 is USART1
    GPIO_SIGNAL_USART_RX,
    GPIO_SIGNAL_CAN_TX, ///< part: 0 is CAN1
    GPIO_SIGNAL_CAN_RX,
};

struct gpio_function {
    enum gpio_signal signal;
    uint8_t part, channel;
};

struct gpio_port {
    struct soc *soc;
    uint8_t index;
    uint32_t moder, otyper, ospeedr, pupdr, odr, lckr, afr[2];
    uint8_t lock_step;
    bool locked;
    struct gpio_function connection[GPIO_PINS_PER_PORT]; ///< follows from MODER and AFR
    // The world outside; survives a reset.
    uint16_t driven, driven_high;
};

void gpio_reset(struct gpio_port *port, struct soc *soc, unsigned index);
uint32_t gpio_read(void *model, uint32_t offset);
void gpio_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// What the pin is connected to now; GPIO_SIGNAL_NONE unless it is in alternate-function mode.
struct gpio_function gpio_connection(const struct soc *soc, unsigned pin);

/// Is the pin connected to that?
bool gpio_is_connected(const struct soc *soc, unsigned pin, enum gpio_signal signal, unsigned part);

/// From outside.
void gpio_drive(struct soc *soc, unsigned pin, enum gpio_drive drive);

/// Level of a pin that the program drives as an output. GPIO_FLOATING: it doesn't.
enum gpio_drive gpio_output(const struct soc *soc, unsigned pin);

/// Level at the pin, as the input register shows it.
bool gpio_level(const struct soc *soc, unsigned pin);

#endif

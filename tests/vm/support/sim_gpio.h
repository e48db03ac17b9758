/// A GPIO bank of the kernel's gpio-sim, and the far side of its pins.
#ifndef VM_SUPPORT_SIM_GPIO_H
#define VM_SUPPORT_SIM_GPIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SIM_GPIO_LABEL "boresight-test"

/// Makes the bank; its name (gpiochipN) goes to chip. One at a time.
void sim_gpio_create(uint32_t line_count, char *chip, size_t capacity);
void sim_gpio_remove(void);

/// Pulls an input's pin to a level, as a switch would.
void sim_gpio_drive(uint32_t offset, bool high);
/// The level at a pin.
bool sim_gpio_is_high(uint32_t offset);

#endif

/// A PCA9685, the I2C board with 16 servo outputs: its registers are those of the kernel's
/// i2c-stub, its driver is the kernel's own. Needs the modules i2c-stub (chip_addr=0x40), i2c-dev
/// and pwm-pca9685.
#ifndef VM_SUPPORT_SIM_PCA9685_H
#define VM_SUPPORT_SIM_PCA9685_H

#include <stddef.h>
#include <stdint.h>

/// The registers as after power-on, and a driver for them; its name (pwmchipN) goes to chip. One at
/// a time.
void sim_pca9685_create(char *chip, size_t capacity);
/// Takes the driver away, with everything that it offers. The registers stay.
void sim_pca9685_remove(void);

/// What an output gives, from the registers as the datasheet explains them (4096 counts a period,
/// 25 MHz). pulse 0: steadily low; the period is then 0.
void sim_pca9685_measure(uint32_t output, uint32_t *pulse_ns, uint32_t *period_ns);

#endif

/// hal/gpio.h on the lines of Linux' GPIO chips, by libgpiod (1.6 or 2.x, whichever is there when
/// the program is built).
///
/// Lines are requested when the device is opened and stay ours until it is closed; the kernel lets
/// nobody else have them in between. Shown: tests/vm/linux_gpio.c (the contract suite and more, on
/// gpio-sim).
#ifndef HAL_LINUX_GPIO_H
#define HAL_LINUX_GPIO_H

#include "fixed/must_check.h"
#include "hal/gpio.h"
#include "linux/linux_error.h"

#define LINUX_GPIO_LINES_MAX  16U
#define LINUX_GPIO_NAME_BYTES 64

/// Where a line of the table is: "gpiochip0" or a chip's label, and the line's number on it.
struct linux_gpio_pin {
    const char *chip;
    uint32_t offset;
};

struct linux_gpio {
    struct hal_gpio hal;
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    struct hal_gpio_line lines[LINUX_GPIO_LINES_MAX];
    char names[LINUX_GPIO_LINES_MAX][LINUX_GPIO_NAME_BYTES]; ///< for messages: gpiochip0:17
    void *held[LINUX_GPIO_LINES_MAX];                        ///< by the library
    uint32_t count;
    bool gone;
};

/// Requests every line, outputs with their first level.
/// lines, pins: count of each, 1 to LINUX_GPIO_LINES_MAX; copied.
/// Returns:  HAL_OK: gpio->hal is bound, close it in the end;
///           HAL_ERROR_GONE: no such chip; HAL_ERROR_ARGUMENT: no such line on it, or count;
///           HAL_ERROR_DENIED: no permission, or another program has a line;
///           HAL_ERROR_UNSUPPORTED: a pull that the chip can't do, or built without libgpiod;
///           HAL_ERROR_IO. If not HAL_OK, no line is held and gpio->error has the line.
/// Must not move in memory afterwards.
enum hal_status linux_gpio_open(struct linux_gpio *gpio, const struct hal_gpio_line *lines,
                                const struct linux_gpio_pin *pins, uint32_t count) MUST_CHECK;

/// Gives the lines back. The pins keep their level or not, as the chip's driver likes: wire what
/// must be off so that it is off when nobody drives it.
void linux_gpio_close(struct linux_gpio *gpio);

/// A chip as `boresight probe` shows it.
struct linux_gpio_chip {
    char name[LINUX_GPIO_NAME_BYTES], label[LINUX_GPIO_NAME_BYTES];
    uint32_t line_count;
    struct linux_error error; ///< why nothing more is known than the name; empty: all is
};

/// All chips, up to capacity, also those that can't be opened. Returns how many there are.
uint32_t linux_gpio_list(struct linux_gpio_chip *chips, uint32_t capacity);

/// "libgpiod 1.6" or the like; null: built without it.
const char *linux_gpio_library(void);

#endif

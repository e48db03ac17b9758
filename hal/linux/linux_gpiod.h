/// The few things that are asked of libgpiod, the same for its versions 1.6 and 2.x, which share
/// no call. For linux_gpio.c, linux_gpio_pulses.c and linux_gpio_steps.c only.
///
/// linux_gpiod_1.c or linux_gpiod_2.c is built, whichever the library is (features.mk); HAVE_GPIOD
/// is its first digit, 0 without it.
/// Shown: tests/vm/linux_gpio.c, with either.
#ifndef HAL_LINUX_GPIOD_H
#define HAL_LINUX_GPIOD_H

#include "hal/gpio.h"
#include "linux/linux_gpio.h"

/// Why a request failed, besides errno.
enum linux_gpiod_step { LINUX_GPIOD_CHIP, LINUX_GPIOD_LINE, LINUX_GPIOD_REQUEST };

/// Requests one line. NULL: errno and *step tell why.
void *linux_gpiod_request(const char *chip, uint32_t offset, const struct hal_gpio_line *line,
                          enum linux_gpiod_step *step);
void linux_gpiod_release(void *held);
/// 0 or 1, logical; negative: errno.
int linux_gpiod_get(void *held);
/// 0; negative: errno.
int linux_gpiod_set(void *held, bool active);
/// Who has a line, for a message; false: nobody, or it can't be told.
bool linux_gpiod_consumer(const char *chip, uint32_t offset, char *name, size_t capacity);
/// Name, label and size of a chip by its path; false: it can't be opened.
bool linux_gpiod_describe(const char *path, struct linux_gpio_chip *chip);

/// linux_gpiod_request with the line for a person, as linux_gpio_open answers. In linux_gpio.c.
enum hal_status linux_gpio_request(const struct linux_gpio_pin *pin,
                                   const struct hal_gpio_line *line, void **held,
                                   struct linux_error *error) MUST_CHECK;

#define LINUX_GPIOD_CONSUMER "boresight"

#endif

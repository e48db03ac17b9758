#include "linux/linux_gpio.h"

#include "linux/linux_gpiod.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if HAVE_GPIOD != 0

#define LIST_REMEDY "`boresight probe` lists the GPIO chips"

// ---------------------------------------------------------------- operations

static enum hal_status failed(struct linux_gpio *gpio, uint32_t line) {
    if (errno == ENODEV || errno == ENXIO) {
        gpio->gone = true;
        linux_error_set(&gpio->error, gpio->names[line], "the chip has gone",
                        "was its adapter unplugged?");
        return HAL_ERROR_GONE;
    }
    return linux_error_from_errno(&gpio->error, gpio->names[line], errno, LIST_REMEDY);
}

static enum hal_status linux_gpio_read(void *ctx, uint32_t line, bool *active) {
    struct linux_gpio *gpio = ctx;
    if (gpio->gone || line >= gpio->count) {
        return gpio->gone ? HAL_ERROR_GONE : HAL_ERROR_ARGUMENT;
    }
    const int level = linux_gpiod_get(gpio->held[line]);
    if (level < 0) {
        return failed(gpio, line);
    }
    *active = level != 0;
    return HAL_OK;
}

static enum hal_status linux_gpio_write(void *ctx, uint32_t line, bool active) {
    struct linux_gpio *gpio = ctx;
    if (gpio->gone) {
        return HAL_ERROR_GONE;
    }
    if (line >= gpio->count || gpio->lines[line].direction != HAL_GPIO_OUTPUT) {
        return HAL_ERROR_ARGUMENT;
    }
    return linux_gpiod_set(gpio->held[line], active) == 0 ? HAL_OK : failed(gpio, line);
}

// ---------------------------------------------------------------- opening

static enum hal_status explain_busy(struct linux_error *error, const struct linux_gpio_pin *pin,
                                    const char *name) {
    char consumer[40], reason[80];
    if (linux_gpiod_consumer(pin->chip, pin->offset, consumer, sizeof consumer)) {
        snprintf(reason, sizeof reason, "in use by '%s'", consumer);
    } else {
        snprintf(reason, sizeof reason, "in use");
    }
    linux_error_set(error, name, reason,
                    "end that program, or take the overlay that claims it out of the device tree");
    return HAL_ERROR_DENIED;
}

/// The library says of much that there is no such file. A label can't be looked for on chips that
/// this user may not open.
static enum hal_status no_chip(struct linux_error *error, const struct linux_gpio_pin *pin,
                               const char *path) {
    int why = errno;
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    if (fd >= 0) {
        close(fd);
        why = why == ENOENT ? ENOTTY : why;
    } else {
        why = errno;
    }
    struct linux_gpio_chip chips[16];
    const uint32_t count = why == ENOENT && pin->chip[0] != '/' ? linux_gpio_list(chips, 16) : 0U;
    for (uint32_t i = 0; i < count && i < 16U; i++) {
        if (chips[i].error.line[0] != '\0') {
            *error = chips[i].error;
            return HAL_ERROR_DENIED;
        }
    }
    return linux_error_from_errno(error, path, why, LIST_REMEDY);
}

static enum hal_status open_failed(struct linux_error *error, const struct linux_gpio_pin *pin,
                                   const char *name, enum linux_gpiod_step step) {
    char path[LINUX_GPIO_NAME_BYTES + 8];
    snprintf(path, sizeof path, "%s%.60s", pin->chip[0] == '/' ? "" : "/dev/", pin->chip);
    if (step == LINUX_GPIOD_CHIP) {
        return no_chip(error, pin, path);
    }
    if (errno == EINVAL) {
        linux_error_set(error, name, "the chip has no such line",
                        "`boresight probe` tells how many it has");
        return HAL_ERROR_ARGUMENT;
    }
    if (errno == EBUSY) {
        return explain_busy(error, pin, name);
    }
    if (errno == ENOTSUP || errno == EOPNOTSUPP) {
        linux_error_set(error, name, "the chip can't do that pull",
                        "leave it out of the rig file and use a resistor");
        return HAL_ERROR_UNSUPPORTED;
    }
    return linux_error_from_errno(error, path, errno, LIST_REMEDY);
}

enum hal_status linux_gpio_request(const struct linux_gpio_pin *pin,
                                   const struct hal_gpio_line *line, void **held,
                                   struct linux_error *error) {
    char name[LINUX_GPIO_NAME_BYTES];
    enum linux_gpiod_step step;
    snprintf(name, sizeof name, "%.48s:%u", pin->chip, (unsigned)pin->offset);
    *held = linux_gpiod_request(pin->chip, pin->offset, line, &step);
    return *held != NULL ? HAL_OK : open_failed(error, pin, name, step);
}

static const struct hal_gpio_ops ops = {linux_gpio_read, linux_gpio_write};

enum hal_status linux_gpio_open(struct linux_gpio *gpio, const struct hal_gpio_line *lines,
                                const struct linux_gpio_pin *pins, uint32_t count) {
    memset(gpio, 0, sizeof *gpio);
    gpio->gone = true; // what can't be opened is gone for whoever goes on calling
    if (hal_gpio_bind(&gpio->hal, &ops, gpio) != HAL_OK || count == 0U ||
        count > LINUX_GPIO_LINES_MAX) {
        linux_error_set(&gpio->error, "GPIO", "no lines, or too many", LIST_REMEDY);
        return HAL_ERROR_ARGUMENT;
    }
    for (uint32_t i = 0; i < count; i++) {
        snprintf(gpio->names[i], sizeof gpio->names[i], "%.48s:%u", pins[i].chip,
                 (unsigned)pins[i].offset);
        gpio->lines[i] = lines[i];
        const enum hal_status status =
            linux_gpio_request(&pins[i], &lines[i], &gpio->held[i], &gpio->error);
        if (status != HAL_OK) {
            linux_gpio_close(gpio);
            return status;
        }
        gpio->count++;
    }
    gpio->gone = false;
    return HAL_OK;
}

void linux_gpio_close(struct linux_gpio *gpio) {
    for (uint32_t i = 0; i < gpio->count; i++) {
        linux_gpiod_release(gpio->held[i]);
    }
    gpio->count = 0;
    gpio->gone = true;
}

// ---------------------------------------------------------------- what is there

static int is_chip(const struct dirent *entry) {
    return strncmp(entry->d_name, "gpiochip", 8) == 0;
}

uint32_t linux_gpio_list(struct linux_gpio_chip *chips, uint32_t capacity) {
    struct dirent **entries = NULL;
    const int found = scandir("/dev", &entries, is_chip, versionsort);
    uint32_t count = 0;
    for (int i = 0; i < found; i++) {
        char path[300];
        struct linux_gpio_chip chip;
        snprintf(path, sizeof path, "/dev/%s", entries[i]->d_name);
        memset(&chip, 0, sizeof chip);
        if (!linux_gpiod_describe(path, &chip)) {
            snprintf(chip.name, sizeof chip.name, "%.40s", entries[i]->d_name);
            (void)linux_error_from_errno(&chip.error, path, errno, LIST_REMEDY);
        }
        if (count < capacity) {
            chips[count] = chip;
        }
        count++;
        free(entries[i]);
    }
    free(entries);
    return count;
}

const char *linux_gpio_library(void) {
    return HAVE_GPIOD == 1 ? "libgpiod 1" : "libgpiod 2";
}

#else

static enum hal_status refuse(const char *chip, struct linux_error *error) {
    linux_error_set(error, chip, "this program was built without libgpiod",
                    "install libgpiod-dev and build it again");
    return HAL_ERROR_UNSUPPORTED;
}

enum hal_status linux_gpio_request(const struct linux_gpio_pin *pin,
                                   const struct hal_gpio_line *line, void **held,
                                   struct linux_error *error) {
    (void)line;
    *held = NULL;
    return refuse(pin->chip, error);
}

void linux_gpiod_release(void *held) {
    (void)held;
}

int linux_gpiod_set(void *held, bool active) {
    (void)held;
    (void)active;
    return -1;
}

enum hal_status linux_gpio_open(struct linux_gpio *gpio, const struct hal_gpio_line *lines,
                                const struct linux_gpio_pin *pins, uint32_t count) {
    (void)lines;
    memset(gpio, 0, sizeof *gpio);
    return refuse(count > 0U ? pins[0].chip : "GPIO", &gpio->error);
}

void linux_gpio_close(struct linux_gpio *gpio) {
    gpio->count = 0;
}

uint32_t linux_gpio_list(struct linux_gpio_chip *chips, uint32_t capacity) {
    (void)chips;
    (void)capacity;
    return 0;
}

const char *linux_gpio_library(void) {
    return NULL;
}

#endif

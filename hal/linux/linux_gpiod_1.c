/// libgpiod 1.6.
#include "linux/linux_gpiod.h"

#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <string.h>

void *linux_gpiod_request(const char *chip, uint32_t offset, const struct hal_gpio_line *line,
                          enum linux_gpiod_step *step) {
    *step = LINUX_GPIOD_CHIP;
    struct gpiod_chip *opened = gpiod_chip_open_lookup(chip);
    if (opened == NULL) {
        return NULL;
    }
    *step = LINUX_GPIOD_LINE;
    struct gpiod_line *found = gpiod_chip_get_line(opened, offset);
    int result = -1;
    if (found != NULL) {
        *step = LINUX_GPIOD_REQUEST;
        const struct gpiod_line_request_config config = {
            .consumer = LINUX_GPIOD_CONSUMER,
            .request_type = line->direction == HAL_GPIO_OUTPUT ? GPIOD_LINE_REQUEST_DIRECTION_OUTPUT
                                                               : GPIOD_LINE_REQUEST_DIRECTION_INPUT,
            .flags = (line->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0) |
                     (line->pull == HAL_GPIO_PULL_UP     ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP
                      : line->pull == HAL_GPIO_PULL_DOWN ? GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN
                                                         : 0)};
        result = gpiod_line_request(found, &config, line->initially_active ? 1 : 0);
    }
    if (result != 0) {
        const int why = errno;
        gpiod_chip_close(opened);
        errno = why;
        return NULL;
    }
    return found;
}

void linux_gpiod_release(void *held) {
    gpiod_chip_close(gpiod_line_get_chip(held)); // and with it the line
}

int linux_gpiod_get(void *held) {
    return gpiod_line_get_value(held);
}

int linux_gpiod_set(void *held, bool active) {
    return gpiod_line_set_value(held, active ? 1 : 0);
}

bool linux_gpiod_consumer(const char *chip, uint32_t offset, char *name, size_t capacity) {
    struct gpiod_chip *opened = gpiod_chip_open_lookup(chip);
    struct gpiod_line *line = opened == NULL ? NULL : gpiod_chip_get_line(opened, offset);
    const char *consumer = line == NULL ? NULL : gpiod_line_consumer(line);
    if (consumer != NULL) {
        snprintf(name, capacity, "%s", consumer);
    }
    if (opened != NULL) {
        gpiod_chip_close(opened);
    }
    return consumer != NULL;
}

bool linux_gpiod_describe(const char *path, struct linux_gpio_chip *chip) {
    struct gpiod_chip *opened = gpiod_chip_open(path);
    if (opened == NULL) {
        return false;
    }
    snprintf(chip->name, sizeof chip->name, "%s", gpiod_chip_name(opened));
    snprintf(chip->label, sizeof chip->label, "%s", gpiod_chip_label(opened));
    chip->line_count = gpiod_chip_num_lines(opened);
    gpiod_chip_close(opened);
    return true;
}

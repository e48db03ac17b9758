/// libgpiod 2.x.
#include "linux/linux_gpiod.h"

#include <dirent.h>
#include <errno.h>
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct held {
    struct gpiod_chip *chip;
    struct gpiod_line_request *request;
    unsigned int offset;
};

/// A chip by name, path or label; since 2.0 the library opens paths only.
static struct gpiod_chip *open_chip(const char *name) {
    char path[LINUX_GPIO_NAME_BYTES + 8];
    snprintf(path, sizeof path, "%s%s", name[0] == '/' ? "" : "/dev/", name);
    struct gpiod_chip *chip = gpiod_chip_open(path);
    if (chip != NULL || errno == EACCES || errno == EPERM) {
        return chip;
    }
    struct linux_gpio_chip chips[16];
    const uint32_t count = linux_gpio_list(chips, 16);
    for (uint32_t i = 0; i < count && i < 16U; i++) {
        if (strcmp(chips[i].label, name) == 0) {
            snprintf(path, sizeof path, "/dev/%.63s", chips[i].name);
            return gpiod_chip_open(path);
        }
    }
    errno = ENOENT;
    return NULL;
}

static bool set_up(struct gpiod_line_settings *settings, const struct hal_gpio_line *line) {
    const bool output = line->direction == HAL_GPIO_OUTPUT;
    gpiod_line_settings_set_active_low(settings, line->active_low);
    return gpiod_line_settings_set_direction(settings, output ? GPIOD_LINE_DIRECTION_OUTPUT
                                                              : GPIOD_LINE_DIRECTION_INPUT) == 0 &&
           (line->pull == HAL_GPIO_PULL_NONE ||
            gpiod_line_settings_set_bias(settings, line->pull == HAL_GPIO_PULL_UP
                                                       ? GPIOD_LINE_BIAS_PULL_UP
                                                       : GPIOD_LINE_BIAS_PULL_DOWN) == 0) &&
           (!output || gpiod_line_settings_set_output_value(
                           settings, line->initially_active ? GPIOD_LINE_VALUE_ACTIVE
                                                            : GPIOD_LINE_VALUE_INACTIVE) == 0);
}

static struct gpiod_line_request *request(struct held *held, const struct hal_gpio_line *line) {
    struct gpiod_line_settings *settings = gpiod_line_settings_new();
    struct gpiod_line_config *config = gpiod_line_config_new();
    struct gpiod_request_config *about = gpiod_request_config_new();
    struct gpiod_line_request *made = NULL;
    if (settings != NULL && config != NULL && about != NULL && set_up(settings, line) &&
        gpiod_line_config_add_line_settings(config, &held->offset, 1, settings) == 0) {
        gpiod_request_config_set_consumer(about, LINUX_GPIOD_CONSUMER);
        made = gpiod_chip_request_lines(held->chip, about, config);
    }
    const int why = errno;
    gpiod_request_config_free(about);
    gpiod_line_config_free(config);
    gpiod_line_settings_free(settings);
    errno = why;
    return made;
}

void *linux_gpiod_request(const char *chip, uint32_t offset, const struct hal_gpio_line *line,
                          enum linux_gpiod_step *step) {
    *step = LINUX_GPIOD_CHIP;
    struct held *held = calloc(1, sizeof *held);
    if (held == NULL) {
        return NULL;
    }
    held->offset = offset;
    held->chip = open_chip(chip);
    if (held->chip != NULL) {
        *step = LINUX_GPIOD_LINE;
        struct gpiod_line_info *info = gpiod_chip_get_line_info(held->chip, offset);
        if (info != NULL) {
            gpiod_line_info_free(info);
            *step = LINUX_GPIOD_REQUEST;
            held->request = request(held, line);
        }
    }
    if (held->request == NULL) {
        const int why = errno;
        if (held->chip != NULL) {
            gpiod_chip_close(held->chip);
        }
        free(held);
        errno = why;
        return NULL;
    }
    return held;
}

void linux_gpiod_release(void *context) {
    struct held *held = context;
    gpiod_line_request_release(held->request);
    gpiod_chip_close(held->chip);
    free(held);
}

int linux_gpiod_get(void *context) {
    const struct held *held = context;
    const enum gpiod_line_value value = gpiod_line_request_get_value(held->request, held->offset);
    return value == GPIOD_LINE_VALUE_ERROR ? -1 : value == GPIOD_LINE_VALUE_ACTIVE;
}

int linux_gpiod_set(void *context, bool active) {
    const struct held *held = context;
    return gpiod_line_request_set_value(
        held->request, held->offset, active ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE);
}

bool linux_gpiod_consumer(const char *chip, uint32_t offset, char *name, size_t capacity) {
    struct gpiod_chip *opened = open_chip(chip);
    struct gpiod_line_info *info = opened == NULL ? NULL : gpiod_chip_get_line_info(opened, offset);
    const char *consumer = info == NULL ? NULL : gpiod_line_info_get_consumer(info);
    const bool known = consumer != NULL;
    if (known) {
        snprintf(name, capacity, "%s", consumer);
    }
    if (info != NULL) {
        gpiod_line_info_free(info);
    }
    if (opened != NULL) {
        gpiod_chip_close(opened);
    }
    return known;
}

bool linux_gpiod_describe(const char *path, struct linux_gpio_chip *chip) {
    struct gpiod_chip *opened = gpiod_chip_open(path);
    struct gpiod_chip_info *info = opened == NULL ? NULL : gpiod_chip_get_info(opened);
    if (info != NULL) {
        snprintf(chip->name, sizeof chip->name, "%s", gpiod_chip_info_get_name(info));
        snprintf(chip->label, sizeof chip->label, "%s", gpiod_chip_info_get_label(info));
        chip->line_count = (uint32_t)gpiod_chip_info_get_num_lines(info);
        gpiod_chip_info_free(info);
    }
    if (opened != NULL) {
        gpiod_chip_close(opened);
    }
    return info != NULL;
}

/// libgpiod 2.x as far as gpiod.h beside this file goes, on version 2 of the kernel's interface,
/// which that library is made for. For tests only.
#include "gpiod.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/gpio.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

struct gpiod_chip {
    int fd;
};
struct gpiod_chip_info {
    struct gpiochip_info info;
};
struct gpiod_line_info {
    struct gpio_v2_line_info info;
};
struct gpiod_line_settings {
    enum gpiod_line_direction direction;
    enum gpiod_line_bias bias;
    bool active_low;
    enum gpiod_line_value value;
};
/// One line is all that the driver asks for.
struct gpiod_line_config {
    unsigned int offset;
    size_t count;
    struct gpiod_line_settings settings;
};
struct gpiod_request_config {
    char consumer[GPIO_MAX_NAME_SIZE];
};
struct gpiod_line_request {
    int fd;
    unsigned int offset;
};

struct gpiod_chip *gpiod_chip_open(const char *path) {
    const int fd = open(path, O_RDWR | O_CLOEXEC);
    struct gpiod_chip *chip = fd < 0 ? NULL : calloc(1, sizeof *chip);
    if (chip != NULL) {
        chip->fd = fd;
    }
    return chip;
}

void gpiod_chip_close(struct gpiod_chip *chip) {
    close(chip->fd);
    free(chip);
}

struct gpiod_chip_info *gpiod_chip_get_info(struct gpiod_chip *chip) {
    struct gpiod_chip_info *info = calloc(1, sizeof *info);
    if (info != NULL && ioctl(chip->fd, GPIO_GET_CHIPINFO_IOCTL, &info->info) != 0) {
        free(info);
        return NULL;
    }
    return info;
}

void gpiod_chip_info_free(struct gpiod_chip_info *info) {
    free(info);
}

const char *gpiod_chip_info_get_name(struct gpiod_chip_info *info) {
    return info->info.name;
}

const char *gpiod_chip_info_get_label(struct gpiod_chip_info *info) {
    return info->info.label;
}

size_t gpiod_chip_info_get_num_lines(struct gpiod_chip_info *info) {
    return info->info.lines;
}

struct gpiod_line_info *gpiod_chip_get_line_info(struct gpiod_chip *chip, unsigned int offset) {
    struct gpiod_line_info *info = calloc(1, sizeof *info);
    if (info != NULL) {
        info->info.offset = offset;
        if (ioctl(chip->fd, GPIO_V2_GET_LINEINFO_IOCTL, &info->info) != 0) {
            free(info);
            return NULL;
        }
    }
    return info;
}

void gpiod_line_info_free(struct gpiod_line_info *info) {
    free(info);
}

const char *gpiod_line_info_get_consumer(struct gpiod_line_info *info) {
    return info->info.consumer[0] != '\0' ? info->info.consumer : NULL;
}

struct gpiod_line_settings *gpiod_line_settings_new(void) {
    struct gpiod_line_settings *settings = calloc(1, sizeof *settings);
    if (settings != NULL) {
        settings->direction = GPIOD_LINE_DIRECTION_AS_IS;
        settings->bias = GPIOD_LINE_BIAS_AS_IS;
    }
    return settings;
}

void gpiod_line_settings_free(struct gpiod_line_settings *settings) {
    free(settings);
}

int gpiod_line_settings_set_direction(struct gpiod_line_settings *settings,
                                      enum gpiod_line_direction direction) {
    settings->direction = direction;
    return 0;
}

int gpiod_line_settings_set_bias(struct gpiod_line_settings *settings, enum gpiod_line_bias bias) {
    settings->bias = bias;
    return 0;
}

void gpiod_line_settings_set_active_low(struct gpiod_line_settings *settings, bool active_low) {
    settings->active_low = active_low;
}

int gpiod_line_settings_set_output_value(struct gpiod_line_settings *settings,
                                         enum gpiod_line_value value) {
    settings->value = value;
    return 0;
}

struct gpiod_line_config *gpiod_line_config_new(void) {
    return calloc(1, sizeof(struct gpiod_line_config));
}

void gpiod_line_config_free(struct gpiod_line_config *config) {
    free(config);
}

int gpiod_line_config_add_line_settings(struct gpiod_line_config *config,
                                        const unsigned int *offsets, size_t num_offsets,
                                        struct gpiod_line_settings *settings) {
    if (num_offsets != 1U || config->count != 0U) {
        errno = EINVAL;
        return -1;
    }
    config->offset = offsets[0];
    config->count = 1;
    config->settings = *settings; // copied, as the library does
    return 0;
}

struct gpiod_request_config *gpiod_request_config_new(void) {
    return calloc(1, sizeof(struct gpiod_request_config));
}

void gpiod_request_config_free(struct gpiod_request_config *config) {
    free(config);
}

void gpiod_request_config_set_consumer(struct gpiod_request_config *config, const char *consumer) {
    snprintf(config->consumer, sizeof config->consumer, "%s", consumer);
}

static __u64 flags_of(const struct gpiod_line_settings *settings) {
    __u64 flags = settings->active_low ? GPIO_V2_LINE_FLAG_ACTIVE_LOW : 0U;
    flags |= settings->direction == GPIOD_LINE_DIRECTION_OUTPUT  ? GPIO_V2_LINE_FLAG_OUTPUT
             : settings->direction == GPIOD_LINE_DIRECTION_INPUT ? GPIO_V2_LINE_FLAG_INPUT
                                                                 : 0U;
    flags |= settings->bias == GPIOD_LINE_BIAS_PULL_UP     ? GPIO_V2_LINE_FLAG_BIAS_PULL_UP
             : settings->bias == GPIOD_LINE_BIAS_PULL_DOWN ? GPIO_V2_LINE_FLAG_BIAS_PULL_DOWN
                                                           : 0U;
    return flags;
}

struct gpiod_line_request *gpiod_chip_request_lines(struct gpiod_chip *chip,
                                                    struct gpiod_request_config *req_cfg,
                                                    struct gpiod_line_config *line_cfg) {
    struct gpio_v2_line_request asked = {.num_lines = 1};
    struct gpiod_line_request *request = calloc(1, sizeof *request);
    if (request == NULL) {
        return NULL;
    }
    asked.offsets[0] = line_cfg->offset;
    memcpy(asked.consumer, req_cfg->consumer, sizeof asked.consumer);
    asked.config.flags = flags_of(&line_cfg->settings);
    if (line_cfg->settings.direction == GPIOD_LINE_DIRECTION_OUTPUT) {
        asked.config.num_attrs = 1;
        asked.config.attrs[0].mask = 1;
        asked.config.attrs[0].attr.id = GPIO_V2_LINE_ATTR_ID_OUTPUT_VALUES;
        asked.config.attrs[0].attr.values = line_cfg->settings.value == GPIOD_LINE_VALUE_ACTIVE;
    }
    if (ioctl(chip->fd, GPIO_V2_GET_LINE_IOCTL, &asked) != 0) {
        free(request);
        return NULL;
    }
    request->fd = asked.fd;
    request->offset = line_cfg->offset;
    return request;
}

void gpiod_line_request_release(struct gpiod_line_request *request) {
    close(request->fd);
    free(request);
}

enum gpiod_line_value gpiod_line_request_get_value(struct gpiod_line_request *request,
                                                   unsigned int offset) {
    struct gpio_v2_line_values values = {.mask = 1};
    if (offset != request->offset ||
        ioctl(request->fd, GPIO_V2_LINE_GET_VALUES_IOCTL, &values) != 0) {
        return GPIOD_LINE_VALUE_ERROR;
    }
    return (values.bits & 1U) != 0U ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
}

int gpiod_line_request_set_value(struct gpiod_line_request *request, unsigned int offset,
                                 enum gpiod_line_value value) {
    struct gpio_v2_line_values values = {.mask = 1, .bits = value == GPIOD_LINE_VALUE_ACTIVE};
    if (offset != request->offset) {
        errno = EINVAL;
        return -1;
    }
    return ioctl(request->fd, GPIO_V2_LINE_SET_VALUES_IOCTL, &values);
}

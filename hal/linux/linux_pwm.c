#include "linux/linux_pwm.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PERIOD_NS     20000000U
#define PERIOD_NS_MIN 100000U
#define PERIOD_NS_MAX 100000000U
/// How often it is looked whether udev has given a new output its permissions, 10 ms apart.
#define PERMISSION_TRIES 50
#define MISSING_REMEDY                                                                             \
    "is the overlay loaded (dtoverlay=pwm-2chan)? `boresight probe` lists the chips"

// ---------------------------------------------------------------- files

static enum hal_status failed(struct linux_pwm *pwm, uint32_t channel) {
    char name[48];
    snprintf(name, sizeof name, "%s output %u", pwm->name, (unsigned)channel);
    if (errno == ENODEV || errno == ENXIO) {
        pwm->gone = true;
        linux_error_set(&pwm->error, name, "the chip has gone", "was its driver unloaded?");
        return HAL_ERROR_GONE;
    }
    return linux_error_from_errno(&pwm->error, name, errno, MISSING_REMEDY);
}

/// The kernel reads a number up to the end of its line.
static bool put_number(int fd, uint32_t number) {
    char text[16];
    const int size = snprintf(text, sizeof text, "%u\n", (unsigned)number);
    return pwrite(fd, text, (size_t)size, 0) == (ssize_t)size;
}

/// First number in a file; -1: it can't be read.
static long get_number(const char *folder, const char *file) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    FILE *stream = fopen(path, "r");
    long number = -1;
    if (stream != NULL) {
        if (fscanf(stream, "%ld", &number) != 1) {
            number = -1;
        }
        fclose(stream);
    }
    return number;
}

// ---------------------------------------------------------------- operations

static struct linux_pwm_channel *find(struct linux_pwm *pwm, uint32_t channel) {
    return channel < LINUX_PWM_CHANNELS_MAX && pwm->channel[channel].open ? &pwm->channel[channel]
                                                                          : NULL;
}

static enum hal_status linux_pwm_limits(void *ctx, uint32_t channel,
                                        struct hal_pwm_limits *limits) {
    struct linux_pwm *pwm = ctx;
    const struct linux_pwm_channel *at = find(pwm, channel);
    if (pwm->gone || at == NULL) {
        return pwm->gone ? HAL_ERROR_GONE : HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){at->period_ns, PERIOD_NS_MIN, PERIOD_NS_MAX, 1};
    return HAL_OK;
}

static enum hal_status linux_pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct linux_pwm *pwm = ctx;
    struct linux_pwm_channel *at = find(pwm, channel);
    if (pwm->gone) {
        return HAL_ERROR_GONE;
    }
    if (at == NULL || period_ns < PERIOD_NS_MIN || period_ns > PERIOD_NS_MAX ||
        period_ns <= at->pulse_ns) {
        return HAL_ERROR_ARGUMENT;
    }
    if (!put_number(at->period_fd, period_ns)) {
        return failed(pwm, channel);
    }
    at->period_ns = period_ns;
    return HAL_OK;
}

static enum hal_status linux_pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct linux_pwm *pwm = ctx;
    struct linux_pwm_channel *at = find(pwm, channel);
    if (pwm->gone) {
        return HAL_ERROR_GONE;
    }
    if (at == NULL || pulse_ns >= at->period_ns) {
        return HAL_ERROR_ARGUMENT;
    }
    if (!put_number(at->duty_fd, pulse_ns)) {
        return failed(pwm, channel);
    }
    const bool enable = pulse_ns != 0U;
    if (enable != at->enabled && !put_number(at->enable_fd, enable ? 1U : 0U)) {
        const enum hal_status status = failed(pwm, channel);
        (void)put_number(at->duty_fd, at->pulse_ns); // the old width holds
        return status;
    }
    at->enabled = enable;
    at->pulse_ns = pulse_ns;
    return HAL_OK;
}

static const struct hal_pwm_ops ops = {linux_pwm_limits, linux_pwm_set_period, linux_pwm_set_pulse};

// ---------------------------------------------------------------- opening

static int open_file(const struct linux_pwm *pwm, uint32_t channel, const char *file) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwm%u/%s", pwm->folder, (unsigned)channel, file);
    return open(path, O_WRONLY | O_CLOEXEC);
}

/// Makes the output's files appear, unless they are there.
static bool export_channel(const struct linux_pwm *pwm, uint32_t channel) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwm%u", pwm->folder, (unsigned)channel);
    if (access(path, F_OK) == 0) {
        return true;
    }
    snprintf(path, sizeof path, "%s/export", pwm->folder);
    const int fd = open(path, O_WRONLY | O_CLOEXEC);
    const bool good = fd >= 0 && put_number(fd, channel);
    const int why = errno;
    if (fd >= 0) {
        close(fd);
    }
    errno = why;
    return good;
}

static bool open_files(struct linux_pwm *pwm, uint32_t channel) {
    struct linux_pwm_channel *at = &pwm->channel[channel];
    for (int i = 0; i < PERMISSION_TRIES; i++) {
        at->enable_fd = open_file(pwm, channel, "enable");
        if (at->enable_fd >= 0 || (errno != EACCES && errno != ENOENT)) {
            break;
        }
        usleep(10000);
    }
    at->period_fd = open_file(pwm, channel, "period");
    at->duty_fd = open_file(pwm, channel, "duty_cycle");
    return at->enable_fd >= 0 && at->period_fd >= 0 && at->duty_fd >= 0;
}

/// Silent, and then 20 ms: a period must never be shorter than the pulse that is set.
static bool quieten(struct linux_pwm_channel *at) {
    (void)put_number(at->enable_fd, 0); // refused while there is no period yet
    (void)put_number(at->duty_fd, 0);
    at->period_ns = PERIOD_NS;
    return put_number(at->period_fd, PERIOD_NS) && put_number(at->duty_fd, 0);
}

static enum hal_status open_channel(struct linux_pwm *pwm, uint32_t channel) {
    struct linux_pwm_channel *at = &pwm->channel[channel];
    at->period_fd = at->duty_fd = at->enable_fd = -1;
    if (!export_channel(pwm, channel)) {
        return failed(pwm, channel);
    }
    at->open = true; // so that close looks at its files
    return open_files(pwm, channel) && quieten(at) ? HAL_OK : failed(pwm, channel);
}

enum hal_status linux_pwm_open(struct linux_pwm *pwm, const char *root, const char *chip,
                               uint32_t channels) {
    memset(pwm, 0, sizeof *pwm);
    snprintf(pwm->folder, sizeof pwm->folder, "%.150s/%.40s", root, chip);
    snprintf(pwm->name, sizeof pwm->name, "%.31s", chip);
    enum hal_status status = hal_pwm_bind(&pwm->hal, &ops, pwm);
    const long there = get_number(pwm->folder, "npwm");
    if (there < 0) {
        linux_error_set(&pwm->error, chip, "no such PWM chip", MISSING_REMEDY);
        status = HAL_ERROR_GONE;
    }
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && status == HAL_OK; i++) {
        if ((channels >> i & 1U) != 0U && (long)i >= there) {
            char reason[80];
            snprintf(reason, sizeof reason, "has %ld outputs, 0 to %ld", there, there - 1);
            linux_error_set(&pwm->error, chip, reason, "choose another channel");
            status = HAL_ERROR_ARGUMENT;
        } else if ((channels >> i & 1U) != 0U) {
            status = open_channel(pwm, i);
        }
    }
    if (status != HAL_OK) {
        linux_pwm_close(pwm);
    }
    return status;
}

void linux_pwm_close(struct linux_pwm *pwm) {
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX; i++) {
        struct linux_pwm_channel *at = &pwm->channel[i];
        if (!at->open) {
            continue;
        }
        if (at->duty_fd >= 0 && at->enable_fd >= 0) {
            (void)put_number(at->duty_fd, 0);
            (void)put_number(at->enable_fd, 0);
        }
        const int fds[] = {at->period_fd, at->duty_fd, at->enable_fd};
        for (unsigned k = 0; k < 3U; k++) {
            if (fds[k] >= 0) {
                close(fds[k]);
            }
        }
        at->open = false;
    }
    pwm->gone = true;
}

// ---------------------------------------------------------------- what is there

static int is_chip(const struct dirent *entry) {
    return strncmp(entry->d_name, "pwmchip", 7) == 0;
}

uint32_t linux_pwm_list(const char *root, struct linux_pwm_chip *chips, uint32_t capacity) {
    struct dirent **entries = NULL;
    const int found = scandir(root, &entries, is_chip, versionsort);
    uint32_t count = 0;
    for (int i = 0; i < found; i++) {
        char folder[300];
        snprintf(folder, sizeof folder, "%s/%s", root, entries[i]->d_name);
        const long channels = get_number(folder, "npwm");
        if (channels >= 0) {
            if (count < capacity) {
                snprintf(chips[count].name, sizeof chips[count].name, "%.31s", entries[i]->d_name);
                chips[count].channel_count = (uint32_t)channels;
            }
            count++;
        }
        free(entries[i]);
    }
    free(entries);
    return count;
}

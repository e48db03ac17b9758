#include "linux/linux_pwm.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#define PERIOD_NS     20000000U
#define PERIOD_NS_MIN 100000U
#define PERIOD_NS_MAX 100000000U
/// How often it is looked whether udev has given a new output its permissions, 10 ms apart.
#define PERMISSION_TRIES 50
#define MISSING_REMEDY                                                                             \
    "is the overlay loaded (pwm-2chan, i2c-pwm-pca9685a)? `boresight probe` lists the chips"

/// What the kernel does not tell of a chip.
struct linux_pwm_kind {
    const char *driver;
    uint32_t output_count;   ///< the kernel may have one more, for all of them at once
    uint32_t steps;          ///< a period
    uint32_t period_step_ns; ///< periods are so many times that; all outputs have the same
    uint32_t period_steps_min, period_steps_max;
};
static const struct linux_pwm_kind kinds[] = {{"pca9685-pwm", 16, 4096, 163840, 4, 256}};

// ---------------------------------------------------------------- files

static enum hal_status failed(struct linux_pwm *pwm, uint32_t channel) {
    char name[48];
    snprintf(name, sizeof name, "%s output %u", pwm->name, (unsigned)channel);
    if (errno == ENODEV || errno == ENXIO) {
        pwm->gone = true;
        linux_error_set(&pwm->error, name, "the chip has gone", "was its driver unloaded?");
        return HAL_ERROR_GONE;
    }
    if (errno == EACCES || errno == EPERM) {
        char path[300];
        const int size =
            snprintf(path, sizeof path, "%s/pwm%u/enable", pwm->folder, (unsigned)channel);
        if (size > 0 && access(path, F_OK) != 0) {
            snprintf(path, sizeof path, "%s/export", pwm->folder);
        }
        return linux_error_denied(&pwm->error, name, path);
    }
    return linux_error_from_errno(&pwm->error, name, errno, MISSING_REMEDY);
}

/// The kernel reads a number up to the end of its line.
static bool put_number(int fd, uint32_t number) {
    char text[16];
    const int size = snprintf(text, sizeof text, "%u\n", (unsigned)number);
    return pwrite(fd, text, (size_t)size, 0) == (ssize_t)size;
}

/// First number in a file; -1: it can't be read, errno tells why.
static long get_number(const char *folder, const char *file) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    FILE *stream = fopen(path, "r");
    long number = -1;
    if (stream != NULL) {
        const bool good = fscanf(stream, "%ld", &number) == 1;
        fclose(stream);
        if (!good) {
            errno = EIO;
            return -1;
        }
    }
    return number;
}

/// The kernel's driver of a chip, "" if there is none to be seen (files that stand for a chip).
/// False: it can't be looked for, errno tells why.
static bool get_driver(const char *folder, char *driver, size_t capacity) {
    char path[300], target[300];
    snprintf(path, sizeof path, "%s/device/driver", folder);
    const ssize_t size = readlink(path, target, sizeof target - 1U);
    target[size < 0 ? 0 : size] = '\0';
    const char *slash = strrchr(target, '/');
    snprintf(driver, capacity, "%.31s", slash != NULL ? slash + 1 : target);
    return size >= 0 || errno == ENOENT || errno == ENOTDIR;
}

/// *kind: null if it is none of those. False: errno.
static bool find_kind(const char *folder, const struct linux_pwm_kind **kind) {
    char driver[32];
    *kind = NULL;
    if (!get_driver(folder, driver, sizeof driver)) {
        return false;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        *kind = strcmp(driver, kinds[i].driver) == 0 ? &kinds[i] : *kind;
    }
    return true;
}

/// Outputs of a chip, and its kind; -1: errno.
static long count_outputs(const char *folder, const struct linux_pwm_kind **kind) {
    if (!find_kind(folder, kind)) {
        return -1;
    }
    const long there = get_number(folder, "npwm");
    const struct linux_pwm_kind *known = *kind;
    return known != NULL && there > (long)known->output_count ? (long)known->output_count : there;
}

// ---------------------------------------------------------------- what a chip makes of it

static uint32_t resolution_ns(const struct linux_pwm *pwm, uint32_t period_ns) {
    return pwm->kind == NULL ? 1U : period_ns / pwm->kind->steps;
}

/// The nearest period that the chip has.
static uint32_t round_period_ns(const struct linux_pwm *pwm, uint32_t period_ns) {
    return pwm->kind == NULL ? period_ns : hal_pwm_round_ns(period_ns, pwm->kind->period_step_ns);
}

/// A pulse as it is asked of the kernel; not less than the period: the chip can't do it.
static uint32_t round_pulse_ns(const struct linux_pwm *pwm, uint32_t pulse_ns, uint32_t period_ns) {
    return pulse_ns >= period_ns ? period_ns
                                 : hal_pwm_round_ns(pulse_ns, resolution_ns(pwm, period_ns));
}

static uint32_t period_ns_min(const struct linux_pwm *pwm) {
    return pwm->kind == NULL ? PERIOD_NS_MIN
                             : pwm->kind->period_steps_min * pwm->kind->period_step_ns;
}

static uint32_t period_ns_max(const struct linux_pwm *pwm) {
    return pwm->kind == NULL ? PERIOD_NS_MAX
                             : pwm->kind->period_steps_max * pwm->kind->period_step_ns;
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
    *limits = (struct hal_pwm_limits){at->period_ns, period_ns_min(pwm), period_ns_max(pwm),
                                      resolution_ns(pwm, at->period_ns)};
    return HAL_OK;
}

/// The outputs whose period changes with that of one of them: a bit each.
static uint32_t sharing(const struct linux_pwm *pwm, uint32_t channel) {
    uint32_t outputs = UINT32_C(1) << channel;
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && pwm->kind != NULL; i++) {
        outputs |= pwm->channel[i].open ? UINT32_C(1) << i : 0U;
    }
    return outputs;
}

/// Whether an output's pulses have to stop while its period changes: a shared one can't be changed
/// while two outputs give pulses.
static bool pauses(const struct linux_pwm *pwm, uint32_t outputs, uint32_t channel) {
    return pwm->kind != NULL && (outputs >> channel & 1U) != 0U && pwm->channel[channel].enabled;
}

static bool put_period(struct linux_pwm *pwm, uint32_t outputs, uint32_t period_ns) {
    bool good = true;
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && good; i++) {
        const struct linux_pwm_channel *at = &pwm->channel[i];
        good = !pauses(pwm, outputs, i) ||
               (put_number(at->enable_fd, 0) && put_number(at->duty_fd, 0));
    }
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && good; i++) {
        good = (outputs >> i & 1U) == 0U || put_number(pwm->channel[i].period_fd, period_ns);
    }
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && good; i++) {
        const struct linux_pwm_channel *at = &pwm->channel[i];
        good = !pauses(pwm, outputs, i) ||
               (put_number(at->duty_fd, round_pulse_ns(pwm, at->pulse_ns, period_ns)) &&
                put_number(at->enable_fd, 1));
    }
    return good;
}

static enum hal_status linux_pwm_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct linux_pwm *pwm = ctx;
    const struct linux_pwm_channel *at = find(pwm, channel);
    if (pwm->gone) {
        return HAL_ERROR_GONE;
    }
    if (at == NULL || period_ns < period_ns_min(pwm) || period_ns > period_ns_max(pwm)) {
        return HAL_ERROR_ARGUMENT;
    }
    const uint32_t outputs = sharing(pwm, channel), before_ns = at->period_ns;
    const uint32_t rounded_ns = round_period_ns(pwm, period_ns);
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX; i++) {
        const uint32_t pulse_ns = pwm->channel[i].pulse_ns;
        if ((outputs >> i & 1U) != 0U &&
            (pulse_ns >= period_ns || round_pulse_ns(pwm, pulse_ns, rounded_ns) >= rounded_ns)) {
            return HAL_ERROR_ARGUMENT;
        }
    }
    if (!put_period(pwm, outputs, rounded_ns)) {
        const enum hal_status status = failed(pwm, channel);
        (void)put_period(pwm, outputs, before_ns); // the old one holds
        return status;
    }
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX; i++) {
        if ((outputs >> i & 1U) != 0U) {
            pwm->channel[i].period_ns = rounded_ns;
        }
    }
    return HAL_OK;
}

static enum hal_status linux_pwm_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct linux_pwm *pwm = ctx;
    struct linux_pwm_channel *at = find(pwm, channel);
    if (pwm->gone) {
        return HAL_ERROR_GONE;
    }
    if (at == NULL || round_pulse_ns(pwm, pulse_ns, at->period_ns) >= at->period_ns) {
        return HAL_ERROR_ARGUMENT;
    }
    if (!put_number(at->duty_fd, round_pulse_ns(pwm, pulse_ns, at->period_ns))) {
        return failed(pwm, channel);
    }
    const bool enable = pulse_ns != 0U;
    if (enable != at->enabled && !put_number(at->enable_fd, enable ? 1U : 0U)) {
        const enum hal_status status = failed(pwm, channel);
        (void)put_number(at->duty_fd, round_pulse_ns(pwm, at->pulse_ns, at->period_ns));
        return status; // the old width holds
    }
    at->enabled = enable;
    at->pulse_ns = pulse_ns;
    return HAL_OK;
}

static const struct hal_pwm_ops ops = {linux_pwm_limits, linux_pwm_set_period, linux_pwm_set_pulse};

enum hal_status linux_pwm_poll(struct linux_pwm *pwm) {
    for (uint32_t i = 0; i < LINUX_PWM_CHANNELS_MAX && !pwm->gone; i++) {
        char first;
        if (pwm->channel[i].open && pread(pwm->channel[i].enable_fd, &first, 1, 0) < 0) {
            return failed(pwm, i);
        }
    }
    return pwm->gone ? HAL_ERROR_GONE : HAL_OK;
}

// ---------------------------------------------------------------- opening

static int open_file(const struct linux_pwm *pwm, uint32_t channel, const char *file) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwm%u/%s", pwm->folder, (unsigned)channel, file);
    return open(path, O_RDWR | O_CLOEXEC);
}

/// Makes the output's files appear, unless they are there.
static bool export_channel(const struct linux_pwm *pwm, uint32_t channel) {
    char path[300];
    snprintf(path, sizeof path, "%s/pwm%u", pwm->folder, (unsigned)channel);
    if (access(path, F_OK) == 0) {
        return true;
    }
    if (errno != ENOENT) {
        return false;
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
    // The kernel lets several programs have one output: among those that ask, one is enough.
    if (at->enable_fd >= 0 && flock(at->enable_fd, LOCK_EX | LOCK_NB) != 0) {
        const int why = errno;
        close(at->enable_fd);
        at->enable_fd = -1;
        errno = why;
    }
    if (at->enable_fd < 0) {
        return false;
    }
    at->period_fd = open_file(pwm, channel, "period");
    at->duty_fd = open_file(pwm, channel, "duty_cycle");
    return at->period_fd >= 0 && at->duty_fd >= 0;
}

/// Silent, and then 20 ms: a period must never be shorter than the pulse that is set.
static bool quieten(const struct linux_pwm *pwm, struct linux_pwm_channel *at) {
    (void)put_number(at->enable_fd, 0); // refused while there is no period, or one it can't do
    (void)put_number(at->duty_fd, 0);
    at->period_ns = round_period_ns(pwm, PERIOD_NS);
    return put_number(at->period_fd, at->period_ns) && put_number(at->duty_fd, 0) &&
           put_number(at->enable_fd, 0);
}

static enum hal_status open_channel(struct linux_pwm *pwm, uint32_t channel) {
    struct linux_pwm_channel *at = &pwm->channel[channel];
    at->period_fd = at->duty_fd = at->enable_fd = -1;
    if (!export_channel(pwm, channel)) {
        return failed(pwm, channel);
    }
    at->open = true; // so that close looks at its files
    return open_files(pwm, channel) && quieten(pwm, at) ? HAL_OK : failed(pwm, channel);
}

static enum hal_status chip_failed(struct linux_pwm *pwm, const char *chip) {
    if (errno != ENOENT && errno != ENOTDIR && errno != ENODEV) {
        return linux_error_from_errno(&pwm->error, chip, errno, MISSING_REMEDY);
    }
    linux_error_set(&pwm->error, chip, "no such PWM chip", MISSING_REMEDY);
    return HAL_ERROR_GONE;
}

enum hal_status linux_pwm_open(struct linux_pwm *pwm, const char *root, const char *chip,
                               uint32_t channels) {
    memset(pwm, 0, sizeof *pwm);
    snprintf(pwm->folder, sizeof pwm->folder, "%.150s/%.40s", root, chip);
    snprintf(pwm->name, sizeof pwm->name, "%.31s", chip);
    enum hal_status status = hal_pwm_bind(&pwm->hal, &ops, pwm);
    const long there = count_outputs(pwm->folder, &pwm->kind);
    if (there < 0) {
        status = chip_failed(pwm, chip);
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
        const struct linux_pwm_kind *kind;
        const long channels = count_outputs(folder, &kind);
        if (channels >= 0) {
            if (count < capacity) {
                (void)get_driver(folder, chips[count].driver, sizeof chips[count].driver);
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

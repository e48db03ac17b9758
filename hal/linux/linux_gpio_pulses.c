#include "linux/linux_gpio_pulses.h"

#include "linux/linux_gpiod.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define PERIOD_NS     20000000U
#define PERIOD_NS_MIN 3000000U
#define PERIOD_NS_MAX 100000000U
#define STEP_NS       1000U ///< finer steps would promise what no thread keeps

// ---------------------------------------------------------------- the thread's side

static bool set_line(struct linux_gpio_pulses *pulses, struct linux_gpio_pulse *pulse, bool high) {
    if (atomic_load(&pulses->failed) || linux_gpiod_set(pulse->held, high) != 0) {
        atomic_store(&pulses->failed, true);
        return false;
    }
    pulse->high = high;
    return true;
}

static void begin_period(struct linux_gpio_pulses *pulses, uint64_t now_ns) {
    const uint32_t period_ns = atomic_load(&pulses->period_ns);
    // On time, the next one begins where the last one ends; late by a whole period, now.
    const bool late = now_ns - pulses->period_end_ns >= period_ns;
    pulses->period_start_ns = late ? now_ns : pulses->period_end_ns;
    pulses->period_end_ns = pulses->period_start_ns + period_ns;
    for (uint32_t i = 0; i < pulses->count; i++) {
        struct linux_gpio_pulse *pulse = &pulses->pulse[i];
        pulse->given_ns = atomic_load(&pulse->wanted_ns);
        if (pulse->given_ns != 0U && set_line(pulses, pulse, true)) {
            pulse->rise_ns = pulses->now_ns();
        }
    }
}

static void end_pulse(struct linux_gpio_pulses *pulses, struct linux_gpio_pulse *pulse) {
    if (!set_line(pulses, pulse, false)) {
        return;
    }
    const uint64_t given_ns = pulses->now_ns() - pulse->rise_ns;
    pthread_mutex_lock(&pulses->jitter_lock);
    linux_jitter_add(&pulses->jitter, given_ns > pulse->given_ns ? given_ns - pulse->given_ns : 0U);
    pthread_mutex_unlock(&pulses->jitter_lock);
}

uint64_t linux_gpio_pulses_work(void *ctx, uint64_t now_ns) {
    struct linux_gpio_pulses *pulses = ctx;
    if (atomic_load(&pulses->failed)) {
        return now_ns + PERIOD_NS;
    }
    bool any_high = false;
    for (uint32_t i = 0; i < pulses->count; i++) {
        struct linux_gpio_pulse *pulse = &pulses->pulse[i];
        if (pulse->high && now_ns >= pulse->rise_ns + pulse->given_ns) {
            end_pulse(pulses, pulse);
        }
        any_high = any_high || pulse->high;
    }
    if (!any_high && now_ns >= pulses->period_end_ns) {
        begin_period(pulses, now_ns);
    }
    uint64_t next_ns = pulses->period_end_ns;
    for (uint32_t i = 0; i < pulses->count; i++) {
        const struct linux_gpio_pulse *pulse = &pulses->pulse[i];
        const uint64_t fall_ns = pulse->rise_ns + pulse->given_ns;
        next_ns = pulse->high && (fall_ns < next_ns || next_ns <= now_ns) ? fall_ns : next_ns;
    }
    return next_ns;
}

// ---------------------------------------------------------------- the program's side

static enum hal_status presence(struct linux_gpio_pulses *pulses) {
    if (pulses->open && atomic_load(&pulses->failed)) {
        linux_error_set(&pulses->error, pulses->chip, "the chip has gone",
                        "was its adapter unplugged?");
    }
    return pulses->open && !atomic_load(&pulses->failed) ? HAL_OK : HAL_ERROR_GONE;
}

static struct linux_gpio_pulse *find(struct linux_gpio_pulses *pulses, uint32_t line) {
    for (uint32_t i = 0; i < pulses->count; i++) {
        if (pulses->pulse[i].line == line) {
            return &pulses->pulse[i];
        }
    }
    return NULL;
}

static enum hal_status pulses_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    struct linux_gpio_pulses *pulses = ctx;
    const enum hal_status status = presence(pulses);
    if (status != HAL_OK || find(pulses, channel) == NULL) {
        return status != HAL_OK ? status : HAL_ERROR_ARGUMENT;
    }
    *limits = (struct hal_pwm_limits){atomic_load(&pulses->period_ns), PERIOD_NS_MIN, PERIOD_NS_MAX,
                                      STEP_NS};
    return HAL_OK;
}

static enum hal_status pulses_set_period(void *ctx, uint32_t channel, uint32_t period_ns) {
    struct linux_gpio_pulses *pulses = ctx;
    const enum hal_status status = presence(pulses);
    if (status != HAL_OK) {
        return status;
    }
    if (find(pulses, channel) == NULL || period_ns < PERIOD_NS_MIN || period_ns > PERIOD_NS_MAX) {
        return HAL_ERROR_ARGUMENT;
    }
    const uint32_t rounded_ns = hal_pwm_round_ns(period_ns, STEP_NS);
    for (uint32_t i = 0; i < pulses->count; i++) {
        if (atomic_load(&pulses->pulse[i].wanted_ns) >= rounded_ns) {
            return HAL_ERROR_ARGUMENT;
        }
    }
    atomic_store(&pulses->period_ns, rounded_ns);
    return HAL_OK;
}

static enum hal_status pulses_set_pulse(void *ctx, uint32_t channel, uint32_t pulse_ns) {
    struct linux_gpio_pulses *pulses = ctx;
    const enum hal_status status = presence(pulses);
    struct linux_gpio_pulse *pulse = find(pulses, channel);
    if (status != HAL_OK || pulse == NULL || pulse_ns > PERIOD_NS_MAX) {
        return status != HAL_OK ? status : HAL_ERROR_ARGUMENT;
    }
    const uint32_t rounded_ns = hal_pwm_round_ns(pulse_ns, STEP_NS);
    if (rounded_ns >= atomic_load(&pulses->period_ns)) {
        return HAL_ERROR_ARGUMENT;
    }
    atomic_store(&pulse->wanted_ns, rounded_ns);
    return HAL_OK;
}

static const struct hal_pwm_ops ops = {pulses_limits, pulses_set_period, pulses_set_pulse};

void linux_gpio_pulses_jitter(struct linux_gpio_pulses *pulses, struct linux_jitter *jitter) {
    pthread_mutex_lock(&pulses->jitter_lock);
    linux_jitter_merge(jitter, &pulses->jitter);
    pthread_mutex_unlock(&pulses->jitter_lock);
}

// ---------------------------------------------------------------- opening

enum hal_status linux_gpio_pulses_prepare(struct linux_gpio_pulses *pulses, const char *chip,
                                          const uint32_t *lines, uint32_t count,
                                          uint64_t (*now_ns)(void)) {
    memset(pulses, 0, sizeof *pulses);
    pulses->now_ns = now_ns;
    pulses->jitter.step = 1000U;
    atomic_store(&pulses->period_ns, PERIOD_NS);
    snprintf(pulses->chip, sizeof pulses->chip, "%.60s", chip);
    pthread_mutex_init(&pulses->jitter_lock, NULL);
    if (hal_pwm_bind(&pulses->hal, &ops, pulses) != HAL_OK || count == 0U ||
        count > LINUX_GPIO_PULSES_MAX) {
        linux_error_set(&pulses->error, chip, "no lines, or too many",
                        "name one line for each servo");
        return HAL_ERROR_ARGUMENT;
    }
    const struct hal_gpio_line output = {.direction = HAL_GPIO_OUTPUT};
    for (uint32_t i = 0; i < count; i++) {
        struct linux_gpio_pulse *pulse = &pulses->pulse[i];
        const struct linux_gpio_pin pin = {chip, lines[i]};
        pulse->line = lines[i];
        const enum hal_status status =
            linux_gpio_request(&pin, &output, &pulse->held, &pulses->error);
        if (status != HAL_OK) {
            linux_gpio_pulses_close(pulses);
            return status;
        }
        pulses->count++;
    }
    pulses->period_end_ns = now_ns();
    pulses->open = true;
    return HAL_OK;
}

enum hal_status linux_gpio_pulses_open(struct linux_gpio_pulses *pulses, const char *chip,
                                       const uint32_t *lines, uint32_t count) {
    const enum hal_status status =
        linux_gpio_pulses_prepare(pulses, chip, lines, count, linux_gpio_thread_now_ns);
    if (status == HAL_OK &&
        !linux_gpio_thread_start(&pulses->thread, linux_gpio_pulses_work, pulses)) {
        linux_error_set(&pulses->error, chip, strerror(errno),
                        "no thread for its pulses: is the system short of memory?");
        linux_gpio_pulses_close(pulses);
        return HAL_ERROR_IO;
    }
    return status;
}

void linux_gpio_pulses_close(struct linux_gpio_pulses *pulses) {
    linux_gpio_thread_stop(&pulses->thread);
    for (uint32_t i = 0; i < pulses->count; i++) {
        atomic_store(&pulses->pulse[i].wanted_ns, 0U);
    }
    for (uint32_t i = 0; i < pulses->count; i++) {
        struct linux_gpio_pulse *pulse = &pulses->pulse[i];
        if (pulse->high && !atomic_load(&pulses->failed)) {
            const uint64_t fall_ns = pulse->rise_ns + pulse->given_ns;
            linux_gpio_thread_sleep_until(fall_ns); // a pulse is not cut
            (void)set_line(pulses, pulse, false);
        }
        linux_gpiod_release(pulse->held);
    }
    pulses->count = 0;
    pulses->open = false;
}

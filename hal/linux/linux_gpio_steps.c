#include "linux/linux_gpio_steps.h"

#include "linux/linux_gpiod.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define WIDTH_NS    UINT64_C(5000)
#define SET_UP_NS   UINT64_C(20000)
#define IDLE_NS     UINT64_C(2000000)  ///< how often a new target is looked for at rest
#define SPAN_NS_MAX UINT64_C(50000000) ///< of one target: a first one is not stretched over minutes
#define RATE_MAX    100000U

static uint64_t apart(int64_t a, int64_t b) {
    return a > b ? (uint64_t)a - (uint64_t)b : (uint64_t)b - (uint64_t)a;
}

static bool set_line(struct linux_gpio_steps *steps, void *held, bool high) {
    if (linux_gpiod_set(held, high) != 0) {
        atomic_store(&steps->failed, true);
        return false;
    }
    return true;
}

/// A new target shares its steps out over the time since the last one.
static void look_at_target(struct linux_gpio_steps *steps, uint64_t now_ns) {
    const int64_t target = atomic_load(&steps->target);
    if (target == steps->seen_target) {
        return;
    }
    const uint64_t since_ns = now_ns - steps->seen_ns;
    const uint64_t span_ns = since_ns < SPAN_NS_MAX ? since_ns : SPAN_NS_MAX;
    const uint64_t way = apart(target, atomic_load(&steps->position));
    const uint64_t pace_ns = way == 0U ? 0U : span_ns / way;
    steps->pace_ns = pace_ns > steps->pace_min_ns ? pace_ns : steps->pace_min_ns;
    steps->seen_target = target;
    steps->seen_ns = now_ns;
    // Never closer to the last step than the fastest pace.
    const uint64_t soonest_ns = steps->last_ns + steps->pace_min_ns;
    steps->due_ns = soonest_ns > now_ns ? soonest_ns : now_ns;
}

static uint64_t begin_step(struct linux_gpio_steps *steps, bool forward, uint64_t now_ns) {
    if (!steps->direction_known || forward != steps->forward) {
        if (set_line(steps, steps->direction, forward)) {
            steps->direction_known = true;
            steps->forward = forward;
            steps->due_ns = now_ns + SET_UP_NS;
        }
        return steps->due_ns;
    }
    if (!set_line(steps, steps->step, true)) {
        return now_ns + IDLE_NS;
    }
    steps->high = true;
    steps->last_ns = now_ns;
    pthread_mutex_lock(&steps->jitter_lock);
    linux_jitter_add(&steps->jitter, now_ns - steps->due_ns);
    pthread_mutex_unlock(&steps->jitter_lock);
    // A late step does not hurry those behind it beyond the fastest pace.
    const uint64_t soonest_ns = now_ns + steps->pace_min_ns;
    steps->due_ns += steps->pace_ns;
    steps->due_ns = steps->due_ns > soonest_ns ? steps->due_ns : soonest_ns;
    atomic_fetch_add(&steps->position, forward ? 1 : -1);
    return now_ns + WIDTH_NS;
}

uint64_t linux_gpio_steps_work(void *ctx, uint64_t now_ns) {
    struct linux_gpio_steps *steps = ctx;
    if (atomic_load(&steps->failed)) {
        return now_ns + IDLE_NS;
    }
    if (steps->high) {
        if (now_ns < steps->last_ns + WIDTH_NS) {
            return steps->last_ns + WIDTH_NS;
        }
        steps->high = !set_line(steps, steps->step, false);
    }
    look_at_target(steps, now_ns);
    const int64_t position = atomic_load(&steps->position);
    if (position == steps->seen_target) {
        return now_ns + IDLE_NS;
    }
    if (now_ns < steps->due_ns) {
        return steps->due_ns < now_ns + IDLE_NS ? steps->due_ns : now_ns + IDLE_NS;
    }
    return begin_step(steps, steps->seen_target > position, now_ns);
}

// ---------------------------------------------------------------- the program's side

enum hal_status linux_gpio_steps_presence(struct linux_gpio_steps *steps) {
    if (steps->open && atomic_load(&steps->failed)) {
        linux_error_set(&steps->error, steps->chip, "the chip has gone",
                        "was its adapter unplugged?");
    }
    return steps->open && !atomic_load(&steps->failed) ? HAL_OK : HAL_ERROR_GONE;
}

enum hal_status linux_gpio_steps_go(struct linux_gpio_steps *steps, int64_t target) {
    atomic_store(&steps->target, target);
    return linux_gpio_steps_presence(steps);
}

int64_t linux_gpio_steps_position(const struct linux_gpio_steps *steps) {
    return atomic_load(&steps->position);
}

void linux_gpio_steps_jitter(struct linux_gpio_steps *steps, struct linux_jitter *jitter) {
    pthread_mutex_lock(&steps->jitter_lock);
    linux_jitter_merge(jitter, &steps->jitter);
    pthread_mutex_unlock(&steps->jitter_lock);
}

enum hal_status linux_gpio_steps_prepare(struct linux_gpio_steps *steps, const char *chip,
                                         uint32_t step_line, uint32_t direction_line,
                                         uint32_t rate_max, int64_t position,
                                         uint64_t (*now_ns)(void)) {
    const struct hal_gpio_line output = {.direction = HAL_GPIO_OUTPUT};
    const struct linux_gpio_pin pins[] = {{chip, step_line}, {chip, direction_line}};
    memset(steps, 0, sizeof *steps);
    steps->now_ns = now_ns;
    steps->jitter.step = 1000U;
    pthread_mutex_init(&steps->jitter_lock, NULL);
    snprintf(steps->chip, sizeof steps->chip, "%.60s", chip);
    atomic_store(&steps->target, position);
    atomic_store(&steps->position, position);
    steps->seen_target = position;
    steps->seen_ns = now_ns();
    if (rate_max == 0U || rate_max > RATE_MAX) {
        linux_error_set(&steps->error, chip, "1 to 100000 steps a second are possible",
                        "set speed_max_dps or steps_per_deg");
        return HAL_ERROR_ARGUMENT;
    }
    steps->pace_min_ns = UINT64_C(1000000000) / rate_max;
    enum hal_status status = linux_gpio_request(&pins[0], &output, &steps->step, &steps->error);
    if (status == HAL_OK) {
        status = linux_gpio_request(&pins[1], &output, &steps->direction, &steps->error);
    }
    steps->open = status == HAL_OK;
    if (status != HAL_OK) {
        linux_gpio_steps_close(steps);
    }
    return status;
}

enum hal_status linux_gpio_steps_open(struct linux_gpio_steps *steps, const char *chip,
                                      uint32_t step_line, uint32_t direction_line,
                                      uint32_t rate_max, int64_t position) {
    const enum hal_status status = linux_gpio_steps_prepare(
        steps, chip, step_line, direction_line, rate_max, position, linux_gpio_thread_now_ns);
    if (status == HAL_OK &&
        !linux_gpio_thread_start(&steps->thread, linux_gpio_steps_work, steps)) {
        linux_error_set(&steps->error, chip, strerror(errno),
                        "no thread for its steps: is the system short of memory?");
        linux_gpio_steps_close(steps);
        return HAL_ERROR_IO;
    }
    return status;
}

void linux_gpio_steps_close(struct linux_gpio_steps *steps) {
    linux_gpio_thread_stop(&steps->thread);
    if (steps->high && !atomic_load(&steps->failed)) {
        (void)linux_gpiod_set(steps->step, false); // the driver has taken the step by its edge
        steps->high = false;
    }
    void **const held[] = {&steps->step, &steps->direction};
    for (unsigned i = 0; i < 2U; i++) {
        if (*held[i] != NULL) {
            linux_gpiod_release(*held[i]);
            *held[i] = NULL;
        }
    }
    steps->open = false;
}

/// Servo pulses, and STEP and DIR, from GPIO lines: in virtual time, on a model of the library that
/// keeps every edge.
#include "contract/support/contract.h"
#include "contract/support/gpiod_model.h"
#include "contract/support/pwm_suite.h"
#include "linux/linux_gpio_pulses.h"
#include "linux/linux_gpio_steps.h"
#include "linux/linux_gpiod.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define MS UINT64_C(1000000)

// ---------------------------------------------------------------- the library

struct gpiod_model gpiod_model;
static struct held { uint32_t line; } held[GPIOD_MODEL_LINES];

uint64_t gpiod_model_now_ns(void) {
    return gpiod_model.now_ns;
}

void gpiod_model_run(uint64_t (*work)(void *ctx, uint64_t now_ns), void *ctx, uint64_t until_ns) {
    uint64_t next_ns = work(ctx, gpiod_model.now_ns);
    while (next_ns <= until_ns) {
        gpiod_model.now_ns = next_ns > gpiod_model.now_ns ? next_ns : gpiod_model.now_ns;
        next_ns = work(ctx, gpiod_model.now_ns);
    }
    gpiod_model.now_ns = until_ns > gpiod_model.now_ns ? until_ns : gpiod_model.now_ns;
}

void *linux_gpiod_request(const char *chip, uint32_t offset, const struct hal_gpio_line *line,
                          enum linux_gpiod_step *step) {
    *step = strcmp(chip, "gpiochip0") != 0 ? LINUX_GPIOD_CHIP
            : offset >= GPIOD_MODEL_LINES  ? LINUX_GPIOD_LINE
                                           : LINUX_GPIOD_REQUEST;
    errno = *step == LINUX_GPIOD_CHIP ? ENOENT : *step == LINUX_GPIOD_LINE ? EINVAL : EBUSY;
    if (*step != LINUX_GPIOD_REQUEST || gpiod_model.busy[offset]) {
        return NULL;
    }
    gpiod_model.busy[offset] = true;
    gpiod_model.high[offset] = line->initially_active;
    gpiod_model.held_count++;
    held[offset].line = offset;
    return &held[offset];
}

void linux_gpiod_release(void *context) {
    gpiod_model.busy[((struct held *)context)->line] = false;
    gpiod_model.held_count--;
}

int linux_gpiod_get(void *context) {
    return gpiod_model.high[((struct held *)context)->line];
}

int linux_gpiod_set(void *context, bool active) {
    const uint32_t line = ((struct held *)context)->line;
    gpiod_model.calls++;
    if (gpiod_model.fail_at != 0U && gpiod_model.calls >= gpiod_model.fail_at) {
        errno = ENODEV;
        return -1;
    }
    if (gpiod_model.high[line] != active && gpiod_model.edge_count < GPIOD_MODEL_EDGES) {
        gpiod_model.edge[gpiod_model.edge_count++] =
            (struct gpiod_model_edge){line, active, gpiod_model.now_ns};
    }
    gpiod_model.high[line] = active;
    gpiod_model.now_ns += gpiod_model.set_cost_ns;
    return 0;
}

bool linux_gpiod_consumer(const char *chip, uint32_t offset, char *name, size_t capacity) {
    (void)chip;
    (void)offset;
    snprintf(name, capacity, "somebody");
    return true;
}

bool linux_gpiod_describe(const char *path, struct linux_gpio_chip *chip) {
    (void)path;
    (void)chip;
    return false;
}

// ---------------------------------------------------------------- pulses

static struct linux_gpio_pulses pulses;
/// The suite's channels are the lines 0 to 3.
static const uint32_t lines[] = {0, 1, 2, 3};

static void reset_pulses(void *context) {
    (void)context;
    linux_gpio_pulses_close(&pulses);
    CHECK_EQ(gpiod_model.held_count, 0);
    memset(&gpiod_model, 0, sizeof gpiod_model);
    gpiod_model.now_ns = 5 * MS;
    CHECK_EQ(linux_gpio_pulses_prepare(&pulses, "gpiochip0", lines, 4, gpiod_model_now_ns), HAL_OK);
}

/// The last whole period on a line: of its last two rising edges, and the fall between.
static void measure(void *context, uint32_t line, uint32_t *pulse_ns, uint32_t *period_ns) {
    (void)context;
    gpiod_model.edge_count = 0;
    gpiod_model_run(linux_gpio_pulses_work, &pulses, gpiod_model.now_ns + 500 * MS);
    uint64_t rise_ns[2] = {0, 0}, fall_ns[2] = {0, 0};
    unsigned rises = 0;
    for (uint32_t i = 0; i < gpiod_model.edge_count; i++) {
        const struct gpiod_model_edge *edge = &gpiod_model.edge[i];
        if (edge->line == line && edge->high) {
            rise_ns[0] = rise_ns[1];
            fall_ns[0] = fall_ns[1];
            rise_ns[1] = edge->at_ns;
            rises++;
        } else if (edge->line == line) {
            fall_ns[1] = edge->at_ns;
        }
    }
    *pulse_ns = rises >= 2U ? (uint32_t)(fall_ns[0] - rise_ns[0]) : 0U;
    struct hal_pwm_limits limits = {.period_ns = 0};
    CHECK_EQ(hal_pwm_limits(&pulses.hal, line, &limits), HAL_OK);
    *period_ns = rises >= 2U ? (uint32_t)(rise_ns[1] - rise_ns[0]) : limits.period_ns;
}

/// What a call of the library costs comes on top of no pulse: it is measured from its own rise.
static void calls_that_take_time(void) {
    reset_pulses(NULL);
    gpiod_model.set_cost_ns = 3000;
    for (uint32_t i = 0; i < 4U; i++) {
        CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, i, 1500000U), HAL_OK); // all fall at once
    }
    gpiod_model_run(linux_gpio_pulses_work, &pulses, gpiod_model.now_ns + 2000 * MS);
    struct linux_jitter jitter = {.step = 1000};
    linux_gpio_pulses_jitter(&pulses, &jitter);
    CHECK(jitter.count >= 396U && jitter.count <= 400U);
    check_note("pulses too long by at most, ns", (int64_t)jitter.max);
    CHECK(jitter.max <= 4U * 3000U);
    CHECK(linux_jitter_quantile(&jitter, 250) <= 4000U);
}

/// A thread that was held up makes one pulse long, says so, and goes on from now.
static void a_held_up_thread(void) {
    reset_pulses(NULL);
    CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 2, 1000000U), HAL_OK);
    gpiod_model_run(linux_gpio_pulses_work, &pulses, gpiod_model.now_ns + 90 * MS);
    const uint64_t next_ns = pulses.period_end_ns;
    gpiod_model.now_ns = next_ns;
    (void)linux_gpio_pulses_work(&pulses, next_ns); // up
    gpiod_model.now_ns = next_ns + 250 * MS;        // and nobody there
    gpiod_model.edge_count = 0;
    gpiod_model_run(linux_gpio_pulses_work, &pulses, gpiod_model.now_ns + 100 * MS);
    struct linux_jitter jitter = {.step = 1000};
    linux_gpio_pulses_jitter(&pulses, &jitter);
    CHECK_EQ(jitter.max, 249 * MS);
    CHECK_EQ(jitter.over, 1);
    CHECK(linux_jitter_quantile(&jitter, 500) <= 1000U);
    CHECK(gpiod_model.edge_count >= 9U && gpiod_model.edge_count <= 13U); // no burst to catch up
}

static void pulses_that_can_not_be_had(void) {
    reset_pulses(NULL);
    struct linux_gpio_pulses other;
    const uint32_t taken[] = {5, 3}, absent[] = {5, 99};
    CHECK_EQ(linux_gpio_pulses_prepare(&other, "gpiochip0", taken, 2, gpiod_model_now_ns),
             HAL_ERROR_DENIED);
    CHECK(strncmp(other.error.line, "gpiochip0:3: in use by 'somebody'; ", 35) == 0);
    CHECK_EQ(hal_pwm_set_pulse(&other.hal, 5, 0), HAL_ERROR_GONE);
    CHECK_EQ(linux_gpio_pulses_prepare(&other, "gpiochip0", absent, 2, gpiod_model_now_ns),
             HAL_ERROR_ARGUMENT);
    CHECK_EQ(linux_gpio_pulses_prepare(&other, "gpiochip7", taken, 2, gpiod_model_now_ns),
             HAL_ERROR_GONE);
    CHECK_EQ(linux_gpio_pulses_prepare(&other, "gpiochip0", taken, 0, gpiod_model_now_ns),
             HAL_ERROR_ARGUMENT);
    CHECK_EQ(gpiod_model.held_count, 4); // the first ones'
}

/// The chip leaves at whichever setting of a line.
static void pulses_of_a_chip_that_leaves(void) {
    for (uint64_t nth = 1; nth <= 40U && check_clean(); nth++) {
        reset_pulses(NULL);
        for (uint32_t i = 0; i < 4U; i++) {
            CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, i, 1000000U + i * 10000U), HAL_OK);
        }
        gpiod_model.fail_at = nth;
        gpiod_model_run(linux_gpio_pulses_work, &pulses, gpiod_model.now_ns + 400 * MS);
        struct hal_pwm_limits limits;
        CHECK_EQ(gpiod_model.calls, nth); // not called again
        CHECK_EQ(hal_pwm_set_pulse(&pulses.hal, 0, 1500000), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_set_period(&pulses.hal, 0, 10000000), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_limits(&pulses.hal, 0, &limits), HAL_ERROR_GONE);
        CHECK(strcmp(pulses.error.line,
                     "gpiochip0: the chip has gone; was its adapter unplugged?") == 0);
    }
}

/// By the thread itself and the clock of this machine: counted, and how late it was is printed.
static void pulses_in_real_time(void) {
    static struct linux_gpio_pulses real;
    linux_gpio_pulses_close(&pulses);
    memset(&gpiod_model, 0, sizeof gpiod_model);
    CHECK_EQ(linux_gpio_pulses_open(&real, "gpiochip0", lines, 2), HAL_OK);
    CHECK_EQ(hal_pwm_set_period(&real.hal, 0, 5000000), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&real.hal, 0, 1500000), HAL_OK);
    CHECK_EQ(hal_pwm_set_pulse(&real.hal, 1, 1000000), HAL_OK);
    struct linux_jitter jitter = {.step = 1000};
    for (int i = 0; i < 30000 && jitter.count < 200U; i++) {
        linux_gpio_thread_sleep_until(linux_gpio_thread_now_ns() + MS);
        jitter = (struct linux_jitter){.step = 1000};
        linux_gpio_pulses_jitter(&real, &jitter);
    }
    linux_gpio_pulses_close(&real);
    CHECK(jitter.count >= 200U);
    CHECK(!gpiod_model.high[0] && !gpiod_model.high[1]);
    CHECK_EQ(gpiod_model.held_count, 0);
    check_note("pulses in real time", (int64_t)jitter.count);
    check_note("ns too long: half of them at most", (int64_t)linux_jitter_quantile(&jitter, 500));
    check_note("ns too long: 99 % at most", (int64_t)linux_jitter_quantile(&jitter, 990));
    check_note("ns too long: all at most", (int64_t)jitter.max);
}

// ---------------------------------------------------------------- steps

#define STEP_LINE      6U
#define DIRECTION_LINE 7U
static struct linux_gpio_steps steps;

static void reset_steps(uint32_t rate_max, int64_t position) {
    linux_gpio_steps_close(&steps);
    memset(&gpiod_model, 0, sizeof gpiod_model);
    gpiod_model.now_ns = 1000 * MS;
    CHECK_EQ(linux_gpio_steps_prepare(&steps, "gpiochip0", STEP_LINE, DIRECTION_LINE, rate_max,
                                      position, gpiod_model_now_ns),
             HAL_OK);
}

/// What a driver does with the edges: where the motor is. Also checks times.
static int64_t motor(int64_t position, uint64_t pace_min_ns) {
    bool forward = false;
    uint64_t direction_ns = 0, rise_ns = 0;
    bool risen = false;
    for (uint32_t i = 0; i < gpiod_model.edge_count; i++) {
        const struct gpiod_model_edge *edge = &gpiod_model.edge[i];
        if (edge->line == DIRECTION_LINE) {
            CHECK(!risen || edge->at_ns - rise_ns >= 5000U);
            forward = edge->high;
            direction_ns = edge->at_ns;
        } else if (edge->high) {
            CHECK(edge->at_ns - direction_ns >= 20000U);
            CHECK(!risen || edge->at_ns - rise_ns >= pace_min_ns);
            position += forward ? 1 : -1;
            rise_ns = edge->at_ns;
            risen = true;
        } else {
            CHECK(edge->at_ns - rise_ns >= 5000U);
        }
    }
    return position;
}

static void steps_arrive(void) {
    static const int64_t targets[] = {0, 1, -1, 100, 100, 37, -2000, 5, 6, 5, 6};
    uint64_t seed = 7;
    reset_steps(20000, 5);
    for (unsigned i = 0; i < 60U; i++) {
        const int64_t target = i < 11U ? targets[i] : (int64_t)(check_random(&seed) % 801U) - 400;
        CHECK_EQ(linux_gpio_steps_go(&steps, target), HAL_OK);
        const uint64_t span = i % 3U == 0U ? 200 : 3; // some are overtaken by the next
        gpiod_model_run(linux_gpio_steps_work, &steps, gpiod_model.now_ns + span * MS);
        CHECK_EQ(motor(5, 50000), linux_gpio_steps_position(&steps));
    }
    CHECK_EQ(linux_gpio_steps_go(&steps, -77), HAL_OK);
    gpiod_model_run(linux_gpio_steps_work, &steps, gpiod_model.now_ns + 500 * MS);
    CHECK_EQ(linux_gpio_steps_position(&steps), -77);
    CHECK_EQ(motor(5, 50000), -77);
}

/// A stream of targets, one a millisecond: an even train, a target behind.
static void a_stream_gives_an_even_train(void) {
    reset_steps(50000, 0);
    for (int64_t ms = 1; ms <= 500; ms++) {
        CHECK_EQ(linux_gpio_steps_go(&steps, ms * 8), HAL_OK);
        gpiod_model_run(linux_gpio_steps_work, &steps, gpiod_model.now_ns + MS);
        CHECK(ms * 8 - linux_gpio_steps_position(&steps) <= 24); // from rest it looks every 2 ms
    }
    uint64_t before_ns = 0, shortest_ns = UINT64_MAX, longest_ns = 0;
    uint32_t rises = 0;
    for (uint32_t i = 0; i < gpiod_model.edge_count; i++) {
        const struct gpiod_model_edge *edge = &gpiod_model.edge[i];
        if (edge->line != STEP_LINE || !edge->high) {
            continue;
        }
        if (++rises > 40U) { // the first targets have no pace yet
            const uint64_t apart_ns = edge->at_ns - before_ns;
            shortest_ns = apart_ns < shortest_ns ? apart_ns : shortest_ns;
            longest_ns = apart_ns > longest_ns ? apart_ns : longest_ns;
        }
        before_ns = edge->at_ns;
    }
    check_note("ns between steps, at least", (int64_t)shortest_ns);
    check_note("ns between steps, at most", (int64_t)longest_ns);
    CHECK(shortest_ns >= 62500U && longest_ns <= 250000U); // 125000 on the whole
    struct linux_jitter jitter = {.step = 1000};
    linux_gpio_steps_jitter(&steps, &jitter);
    CHECK_EQ(jitter.max, 0);
}

static void steps_of_a_chip_that_leaves(void) {
    for (uint64_t nth = 1; nth <= 30U && check_clean(); nth++) {
        reset_steps(20000, 0);
        gpiod_model.fail_at = nth;
        CHECK_EQ(linux_gpio_steps_go(&steps, 100), HAL_OK);
        gpiod_model_run(linux_gpio_steps_work, &steps, gpiod_model.now_ns + 400 * MS);
        CHECK_EQ(gpiod_model.calls, nth);
        CHECK_EQ(linux_gpio_steps_go(&steps, 200), HAL_ERROR_GONE);
        CHECK(strcmp(steps.error.line,
                     "gpiochip0: the chip has gone; was its adapter unplugged?") == 0);
        CHECK_EQ(motor(0, 50000), linux_gpio_steps_position(&steps));
    }
    linux_gpio_steps_close(&steps);
    CHECK_EQ(linux_gpio_steps_prepare(&steps, "gpiochip0", 6, 7, 0, 0, gpiod_model_now_ns),
             HAL_ERROR_ARGUMENT);
    CHECK_EQ(linux_gpio_steps_prepare(&steps, "gpiochip0", 6, 7, 100001, 0, gpiod_model_now_ns),
             HAL_ERROR_ARGUMENT);
    gpiod_model.busy[7] = true;
    CHECK_EQ(linux_gpio_steps_prepare(&steps, "gpiochip0", 6, 7, 1000, 0, gpiod_model_now_ns),
             HAL_ERROR_DENIED);
    CHECK(!gpiod_model.busy[6]); // given back
}

int main(void) {
    reset_pulses(NULL);
    pwm_suite(&(struct pwm_fixture){.name = "linux_gpio_pulses",
                                    .pwm = &pulses.hal,
                                    .channel_count = 4,
                                    .reset = reset_pulses,
                                    .measure = measure});
    CONTRACT("linux_gpio_pulses", calls_that_take_time);
    CONTRACT("linux_gpio_pulses", a_held_up_thread);
    CONTRACT("linux_gpio_pulses", pulses_that_can_not_be_had);
    CONTRACT("linux_gpio_pulses", pulses_of_a_chip_that_leaves);
    CONTRACT("linux_gpio_pulses", pulses_in_real_time);
    CONTRACT("linux_gpio_steps", steps_arrive);
    CONTRACT("linux_gpio_steps", a_stream_gives_an_even_train);
    CONTRACT("linux_gpio_steps", steps_of_a_chip_that_leaves);
    return check_finish();
}

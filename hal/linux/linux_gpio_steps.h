/// A stepper driver with STEP and DIR inputs (A4988, DRV8825, TMC2209) on two GPIO lines: a thread
/// makes the steps.
///
/// It is told positions, in steps; those that one position asks for are spread evenly over the time
/// that passed since the one before, so that a stream of positions gives an even train, behind by
/// one position. A driver tells nobody where the motor is: steps that it lost are not noticed.
/// STEP pulses last 5 us; DIR is set 20 us before the first of a direction.
/// Shown: tests/contract/linux_gpio_edges.c (in virtual time), tests/vm/linux_gpio.c (on gpio-sim).
#ifndef HAL_LINUX_GPIO_STEPS_H
#define HAL_LINUX_GPIO_STEPS_H

#include "fixed/must_check.h"
#include "hal/status.h"
#include "linux/linux_error.h"
#include "linux/linux_gpio.h"
#include "linux/linux_gpio_thread.h"
#include "linux/linux_jitter.h"

struct linux_gpio_steps {
    /// Why the last call failed.
    struct linux_error error;

    // Private from here on.
    char chip[LINUX_GPIO_NAME_BYTES];
    struct linux_gpio_thread thread;
    uint64_t (*now_ns)(void);
    bool open;
    atomic_bool failed; ///< by the thread: a line could not be set
    void *step, *direction;
    _Atomic int64_t target, position;
    uint64_t pace_min_ns; ///< between two steps
    // The thread's.
    int64_t seen_target;
    uint64_t seen_ns, pace_ns, due_ns, last_ns;
    bool high, forward, direction_known;
    pthread_mutex_t jitter_lock;
    struct linux_jitter jitter; ///< ns by which steps were late
};

/// Requests the lines and starts the thread.
/// position: where the motor stands, in steps. rate_max: steps a second, 1 to 100000.
/// Returns:  as linux_gpio_open; HAL_ERROR_IO also if there is no thread to be had. If not HAL_OK,
///           nothing is open and steps->error has the line. Must not move in memory afterwards.
enum hal_status linux_gpio_steps_open(struct linux_gpio_steps *steps, const char *chip,
                                      uint32_t step_line, uint32_t direction_line,
                                      uint32_t rate_max, int64_t position) MUST_CHECK;
/// Stops where it is.
void linux_gpio_steps_close(struct linux_gpio_steps *steps);

/// Where to go. Returns: HAL_OK; HAL_ERROR_GONE: a line can't be set any more.
enum hal_status linux_gpio_steps_go(struct linux_gpio_steps *steps, int64_t target) MUST_CHECK;
/// Steps made so far, from the position it was opened with.
int64_t linux_gpio_steps_position(const struct linux_gpio_steps *steps);
/// HAL_OK or HAL_ERROR_GONE.
enum hal_status linux_gpio_steps_presence(struct linux_gpio_steps *steps);

/// How late steps came so far. Adds to *jitter, whose step is 1000 (ns).
void linux_gpio_steps_jitter(struct linux_gpio_steps *steps, struct linux_jitter *jitter);

/// The thread's work, for tests that bring a clock of their own: opens without a thread.
enum hal_status linux_gpio_steps_prepare(struct linux_gpio_steps *steps, const char *chip,
                                         uint32_t step_line, uint32_t direction_line,
                                         uint32_t rate_max, int64_t position,
                                         uint64_t (*now_ns)(void)) MUST_CHECK;
uint64_t linux_gpio_steps_work(void *steps, uint64_t now_ns);

#endif

/// What the physical side of the simulator costs: two RMD axes under way, a servo, and the bus, a
/// tick of 1 ms. Prints the figures that the headers of host-sim/devices and host-sim/plant quote.
/// The limit is far above them: machines differ, and others may be busy; processor time is counted,
/// and the best of five runs.
#include "check.h"

#include "devices/pwm_servo.h"
#include "devices/rmd_drive.h"
#include "world/trace_hash.h"

#include <stdio.h>
#include <time.h>

static struct can_bus bus;
static struct axis_plant plants[2];
static struct rmd_drive drives[2];
static struct can_node host;
static struct can_rx_queue replies;
static struct pwm_servo servo;

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void init(void) {
    const struct axis_plant_config axes[2] = {axis_plant_pan(), axis_plant_tilt()};
    const struct pwm_servo_config c = pwm_servo_defaults();
    can_bus_init(&bus, 1000000, 1);
    (void)can_bus_attach(&bus, &host, can_rx_queue_receive, &replies);
    for (unsigned i = 0; i < 2U; i++) {
        const struct rmd_drive_config drive = rmd_drive_defaults((uint8_t)(i + 1U));
        axis_plant_init(&plants[i], &axes[i], 0.0);
        (void)rmd_drive_init(&drives[i], &drive, &plants[i], &bus, i);
    }
    pwm_servo_init(&servo, &c, 0.0, 0, 1);
}

static void send(unsigned axis, uint8_t command, int32_t value) {
    const uint32_t v = (uint32_t)value;
    const struct can_frame f = {.id = 0x141U + axis,
                                .length = 8,
                                .data = {command, 0, 0, 0, (uint8_t)v, (uint8_t)(v >> 8),
                                         (uint8_t)(v >> 16), (uint8_t)(v >> 24)}};
    (void)can_bus_send(&bus, &host, &f, 0);
}

struct load {
    const char *name;
    bool axes, hash;
    unsigned requests; ///< position and angle, in each of so many of 4 ticks
};

/// Nanoseconds a tick.
static double measure(const struct load *load) {
    enum { TICKS = 200000 };
    init();
    uint64_t hash = TRACE_HASH_START;
    int32_t target = 0, step = 5;
    const double start = seconds();
    for (unsigned ms = 0; ms < TICKS; ms++) {
        target += step;
        step = target > 6000 || target < -6000 ? -step : step;
        if (ms % 4U < load->requests) {
            send(ms % 2U, 0xA4, target);
            send(ms % 2U, 0x92, 0);
        }
        pwm_servo_set_pulse(&servo, 1500000U + (ms & 0x3FFFFU));
        const uint64_t t = (ms + 1U) * UINT64_C(1000000);
        can_bus_run_until(&bus, t);
        for (unsigned i = 0; i < 2U && load->axes; i++) {
            rmd_drive_advance(&drives[i], t);
        }
        pwm_servo_advance(&servo, t);
        for (unsigned i = 0; i < 2U && load->hash; i++) {
            hash = axis_plant_hash(&plants[i], rmd_drive_hash(&drives[i], hash));
        }
        hash = load->hash ? can_bus_hash(&bus, pwm_servo_hash(&servo, hash)) : hash;
        replies.count = 0;
    }
    return (seconds() - start) * 1e9 / TICKS + (hash == 0U ? 1.0 : 0.0);
}

static void cost_of_a_tick(void) {
    static const struct load loads[] = {
        {"servo only", false, false, 0},
        {"two axes, output off, no frames", true, false, 0},
        {"two axes under way, 2 frames a tick", true, false, 2},
        {"two axes under way, 4 frames a tick", true, false, 4},
        {"two axes under way, 2 frames a tick, trace hash", true, true, 2},
    };
    double last = 0.0;
    for (unsigned i = 0; i < sizeof loads / sizeof *loads; i++) {
        double best = 1e9;
        for (unsigned k = 0; k < 5U; k++) {
            const double ns = measure(&loads[i]);
            best = ns < best ? ns : best;
        }
        printf("# %-50s %6.0f ns a tick\n", loads[i].name, best);
        last = best;
    }
    CHECK(last < 5000.0);
}

int main(void) {
    TEST(cost_of_a_tick);
    return check_finish();
}

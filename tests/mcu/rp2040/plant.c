/// The pulses of the Raspberry Pi Pico's image on the simulator's servos: how well the camera looks
/// at the target. Reads a trace (tests/mcu/rp2040/run.mjs): `edge NS AXIS LEVEL` when a servo
/// line changes, `aim NS X Y Z` where the target is.
#include "check.h"

#include "devices/pwm_servo.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#define SETTLE_NS UINT64_C(2000000000)
#define SILENT_NS UINT64_C(60000000) ///< three frames
#define RADIAN    0.017453292519943295

static const char *path;
static struct pwm_servo servo[2];
static uint64_t rose_ns[2], fell_ns[2], pulses[2];
static double error_max_deg, error_squares;
static unsigned errors;

static double error_deg(const double target[3]) {
    const double pan = servo[0].angle_deg * RADIAN, tilt = servo[1].angle_deg * RADIAN;
    const double ahead[3] = {sin(pan) * cos(tilt), cos(pan) * cos(tilt), sin(tilt)};
    double apart = 0.0;
    for (int i = 0; i < 3; i++) {
        apart += (ahead[i] - target[i]) * (ahead[i] - target[i]);
    }
    return 2.0 * asin(sqrt(apart) / 2.0) / RADIAN;
}

static void advance(uint64_t now_ns) {
    for (int axis = 0; axis < 2; axis++) {
        if (now_ns - fell_ns[axis] > SILENT_NS) {
            pwm_servo_set_pulse(&servo[axis], 0);
        }
        pwm_servo_advance(&servo[axis], now_ns);
    }
}

static void edge(uint64_t now_ns, int axis, int level) {
    if (level != 0) {
        rose_ns[axis] = now_ns;
    } else if (rose_ns[axis] != 0U) {
        pwm_servo_set_pulse(&servo[axis], (uint32_t)(now_ns - rose_ns[axis]));
        fell_ns[axis] = now_ns;
        pulses[axis]++;
    }
}

static void start(uint64_t now_ns) {
    const struct pwm_servo_config config = pwm_servo_defaults();
    for (unsigned axis = 0; axis < 2U; axis++) {
        pwm_servo_init(&servo[axis], &config, 0.0, now_ns, 1U + axis);
        fell_ns[axis] = now_ns;
    }
}

static void tracks_the_target(void) {
    FILE *trace = fopen(path, "r");
    if (!CHECK(trace != NULL)) {
        return;
    }
    char line[160];
    uint64_t first_ns = 0, now_ns = 0;
    while (fgets(line, sizeof line, trace) != NULL) {
        int axis, level;
        double target[3];
        const bool is_edge = sscanf(line, "edge %" SCNu64 " %d %d", &now_ns, &axis, &level) == 3;
        const bool is_aim = !is_edge && sscanf(line, "aim %" SCNu64 " %lf %lf %lf", &now_ns,
                                               &target[0], &target[1], &target[2]) == 4;
        if (!CHECK(is_edge || is_aim)) {
            break;
        }
        if (first_ns == 0U) {
            start(now_ns);
            first_ns = now_ns;
        }
        advance(now_ns);
        if (is_edge) {
            edge(now_ns, axis, level);
        } else if (now_ns - first_ns > SETTLE_NS) {
            const double error = error_deg(target);
            error_max_deg = error > error_max_deg ? error : error_max_deg;
            error_squares += error * error;
            errors++;
        }
    }
    (void)fclose(trace);
    CHECK(errors > 250U);
    CHECK_NEAR(pulses[0], 400, 2); // 8 s of 50 a second
    CHECK_NEAR(pulses[1], 400, 2);
    CHECK_EQ(servo[0].ignored + servo[1].ignored, 0);
    check_note("aim error, thousandths of a degree, rms",
               (int64_t)(1000.0 * sqrt(error_squares / (errors + 1e-9))));
    check_note("aim error, thousandths of a degree, largest", (int64_t)(1000.0 * error_max_deg));
    // The target turns by 26 degrees a second at most. A new width waits up to 20 ms for its pulse,
    // the pulse up to 20 ms for the servo to measure it, and the servo lags by 10 ms: 1.3 degrees.
    CHECK(error_max_deg < 1.3);
    CHECK(error_max_deg > 0.05); // or the plant does not lag, and nothing is shown
}

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: plant TRACE\n");
        return 2;
    }
    path = argv[1];
    TEST(tracks_the_target);
    return check_finish();
}

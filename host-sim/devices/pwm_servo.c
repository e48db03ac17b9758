#include "devices/pwm_servo.h"

#include "world/trace_hash.h"

#define STEP_NS           UINT64_C(1000000)
#define STEP_S            0.001
#define FRAMES_TO_LET_GO  3U
#define US_PER_NS         0.001
#define WIDE_NS           UINT32_C(1000000)
#define TELE_NS           UINT32_C(2000000)
#define EIGHTH_ROOT_OF_10 1.3335214321633240 // 10^(1/8)

struct pwm_servo_config pwm_servo_defaults(void) {
    return (struct pwm_servo_config){
        .frame_ns = 20000000,
        .pulse_ns_min = 800000,
        .pulse_ns_max = 2200000,
        .pulse_ns_centre = 1500000,
        .dead_band_ns = 2000,
        .deg_per_us = 0.09,
        .speed_dps_max = 60.0 / 0.10,
        .approach = 100.0,
    };
}

void pwm_servo_init(struct pwm_servo *servo, const struct pwm_servo_config *config,
                    double angle_deg, uint64_t now_ns, uint64_t seed) {
    *servo = (struct pwm_servo){.now_ns = now_ns, .angle_deg = angle_deg, .config = *config};
    servo->frames_without = FRAMES_TO_LET_GO;
    const uint64_t mixed = (seed + 1U) * UINT64_C(0x9E3779B97F4A7C15);
    servo->next_sample_ns = now_ns + ((mixed >> 32) * config->frame_ns >> 32);
}

void pwm_servo_set_pulse(struct pwm_servo *servo, uint32_t pulse_ns) {
    servo->pulse_ns = pulse_ns;
}

bool pwm_servo_powered(const struct pwm_servo *servo) {
    return servo->frames_without < FRAMES_TO_LET_GO;
}

static void sample(struct pwm_servo *servo) {
    const struct pwm_servo_config *c = &servo->config;
    servo->next_sample_ns += c->frame_ns;
    if (servo->pulse_ns == 0U) {
        servo->frames_without += pwm_servo_powered(servo) ? 1U : 0U;
        return;
    }
    servo->frames_without = 0;
    if (servo->pulse_ns < c->pulse_ns_min || servo->pulse_ns > c->pulse_ns_max) {
        servo->ignored++;
        return;
    }
    servo->accepted_ns = servo->pulse_ns;
}

static void step(struct pwm_servo *servo) {
    const struct pwm_servo_config *c = &servo->config;
    servo->rate_dps = 0.0;
    if (!pwm_servo_powered(servo) || servo->accepted_ns == 0U || servo->stuck) {
        return;
    }
    const double offset_us = ((double)servo->accepted_ns - (double)c->pulse_ns_centre) * US_PER_NS;
    const double left = offset_us * c->deg_per_us - servo->angle_deg;
    const double rest = (double)c->dead_band_ns * (0.5 * US_PER_NS) * c->deg_per_us;
    if (left <= rest && left >= -rest) {
        return;
    }
    double rate = left * c->approach;
    rate = rate > c->speed_dps_max ? c->speed_dps_max : rate;
    rate = rate < -c->speed_dps_max ? -c->speed_dps_max : rate;
    servo->rate_dps = rate;
    servo->angle_deg += rate * STEP_S;
}

void pwm_servo_advance(struct pwm_servo *servo, uint64_t t_ns) {
    while (servo->now_ns + STEP_NS <= t_ns) {
        servo->now_ns += STEP_NS;
        if (servo->next_sample_ns <= servo->now_ns) {
            sample(servo);
        }
        step(servo);
    }
}

uint64_t pwm_servo_hash(const struct pwm_servo *servo, uint64_t hash) {
    hash = trace_hash_f64(hash, servo->angle_deg);
    hash = trace_hash_u64(hash, servo->accepted_ns | (uint64_t)servo->frames_without << 32 |
                                    (uint64_t)servo->stuck << 40);
    return trace_hash_u64(hash, servo->next_sample_ns);
}

struct zoom_lens_config zoom_lens_defaults(void) {
    struct zoom_lens_config c = {.servo = pwm_servo_defaults(), .focal_mm = {6.0}};
    for (unsigned i = 1; i < ZOOM_LENS_POINTS; i++) {
        c.focal_mm[i] = c.focal_mm[i - 1U] * EIGHTH_ROOT_OF_10;
    }
    const double centre = c.servo.pulse_ns_centre;
    c.wide_deg = (WIDE_NS - centre) * US_PER_NS * c.servo.deg_per_us;
    c.tele_deg = (TELE_NS - centre) * US_PER_NS * c.servo.deg_per_us;
    c.servo.speed_dps_max = (c.tele_deg - c.wide_deg) / 2.0;
    c.servo.approach = 20.0;
    return c;
}

void zoom_lens_init(struct zoom_lens *lens, const struct zoom_lens_config *config, uint64_t now_ns,
                    uint64_t seed) {
    lens->config = *config;
    pwm_servo_init(&lens->servo, &config->servo, config->wide_deg, now_ns, seed);
}

double zoom_lens_focal_mm(const struct zoom_lens *lens) {
    const struct zoom_lens_config *c = &lens->config;
    const double way = (lens->servo.angle_deg - c->wide_deg) / (c->tele_deg - c->wide_deg) *
                       (ZOOM_LENS_POINTS - 1);
    if (way <= 0.0) {
        return c->focal_mm[0];
    }
    if (way >= ZOOM_LENS_POINTS - 1) {
        return c->focal_mm[ZOOM_LENS_POINTS - 1];
    }
    const unsigned i = (unsigned)way;
    return c->focal_mm[i] + (way - i) * (c->focal_mm[i + 1U] - c->focal_mm[i]);
}

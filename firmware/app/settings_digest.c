#include "app/settings_digest.h"

/// Reflected, as in Ethernet: 0xEDB88320. Bitwise: it runs once, at the start.
static void add(uint32_t *crc, uint64_t value) {
    for (unsigned byte = 0; byte < 8U; byte++) {
        *crc ^= (uint32_t)(value >> (8U * byte)) & 0xFFU;
        for (unsigned bit = 0; bit < 8U; bit++) {
            *crc = *crc >> 1 ^ ((*crc & 1U) != 0U ? 0xEDB88320U : 0U);
        }
    }
}

static void add_signed(uint32_t *crc, int64_t value) {
    add(crc, (uint64_t)value);
}

static void add_drive(uint32_t *crc, const struct drive_config *drive) {
    add(crc, (uint64_t)drive->kind);
    if (drive->kind == DRIVE_RMD) {
        const struct drive_rmd_config *rmd = &drive->rmd;
        add(crc, rmd->id);
        add(crc, rmd->reply_offset);
        add(crc, rmd->reversed);
        add_signed(crc, rmd->zero_q48);
        add(crc, rmd->speed_max_dps);
        add(crc, rmd->watchdog_ms);
    } else if (drive->kind == DRIVE_PWM) {
        const struct drive_pwm_config *pwm = &drive->pwm;
        add(crc, pwm->channel);
        add_signed(crc, pwm->low_q48);
        add_signed(crc, pwm->high_q48);
        add(crc, pwm->low_pulse_ns);
        add(crc, pwm->high_pulse_ns);
    }
}

static void add_axis(uint32_t *crc, const struct controller_axis_config *axis) {
    add_drive(crc, &axis->drive);
    if (axis->drive.kind == DRIVE_NONE) {
        return;
    }
    add_signed(crc, axis->limits.min_q48);
    add_signed(crc, axis->limits.max_q48);
    add_signed(crc, axis->limits.speed_max_q48);
    add_signed(crc, axis->limits.accel_max_q48);
    add(crc, axis->limits.smooth_ticks);
    add_signed(crc, axis->home_q48);
    add(crc, axis->latency_us);
}

static void add_lens(uint32_t *crc, const struct lens_config *lens) {
    add(crc, lens->point_count);
    for (uint32_t i = 0; i < lens->point_count && i < LENS_TABLE_MAX; i++) {
        add(crc, lens->point[i].focal_um);
        add_signed(crc, lens->point[i].position_q48);
    }
    add(crc, lens->sensor_width_um);
    add(crc, lens->sensor_height_um);
    add(crc, lens->margin_q16);
}

uint32_t settings_digest(const struct controller_config *config) {
    uint32_t crc = UINT32_MAX;
    add(&crc, config->tick_us);
    add_signed(&crc, config->position_um.x);
    add_signed(&crc, config->position_um.y);
    add_signed(&crc, config->position_um.z);
    add(&crc, config->attitude.heading.bam);
    add(&crc, config->attitude.pitch.bam);
    add(&crc, config->attitude.roll.bam);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        add_axis(&crc, &config->axis[axis]);
    }
    add_lens(&crc, &config->lens);
    add(&crc, (uint64_t)config->frame);
    add(&crc, config->target_expiry_us);
    add_signed(&crc, config->tracker.jump_q48);
    add(&crc, config->tracker.memory_q16);
    add(&crc, config->tracker.coast_ticks);
    add(&crc, config->silence_us);
    add(&crc, config->settle_us);
    add_signed(&crc, config->follow_error_q48);
    add(&crc, config->follow_error_us);
    return ~crc;
}

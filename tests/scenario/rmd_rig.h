/// A bus with RMD drives that turn axes of the default gimbal, and a host node that speaks raw
/// bytes: for the tests of devices/rmd_drive.
#ifndef TESTS_SCENARIO_RMD_RIG_H
#define TESTS_SCENARIO_RMD_RIG_H

#include "check.h"

#include "devices/rmd_drive.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MS         UINT64_C(1000000)
#define DEG        (AXIS_PLANT_PI / 180.0)
#define BYTES(...) ((const uint8_t[8]){__VA_ARGS__})

struct rig {
    struct can_bus bus;
    struct axis_plant plant;
    struct rmd_drive drive;
    struct can_node host;
    struct can_rx_queue replies;
};

static inline void rig_init(struct rig *r, struct axis_plant_config axis,
                            struct rmd_drive_config drive, double angle_deg) {
    memset(r, 0, sizeof *r);
    can_bus_init(&r->bus, 1000000, 1);
    CHECK(can_bus_attach(&r->bus, &r->host, can_rx_queue_receive, &r->replies));
    axis_plant_init(&r->plant, &axis, angle_deg * DEG);
    CHECK(rmd_drive_init(&r->drive, &drive, &r->plant, &r->bus, 42));
}

/// Up to the given millisecond after now.
static inline void rig_run_us(struct rig *r, uint64_t us) {
    const uint64_t end = r->bus.now_ns + us * 1000U;
    while (r->bus.now_ns < end) {
        const uint64_t next = r->bus.now_ns + MS < end ? r->bus.now_ns + MS : end;
        can_bus_run_until(&r->bus, next);
        rmd_drive_advance(&r->drive, next);
    }
}

static inline void rig_run(struct rig *r, unsigned ms) {
    rig_run_us(r, ms * 1000ULL);
}

static inline void rig_send(struct rig *r, const uint8_t *bytes) {
    struct can_frame f = {.id = 0x140U + r->drive.config.id, .length = 8};
    memcpy(f.data, bytes, 8);
    CHECK(can_bus_send(&r->bus, &r->host, &f, 0));
}

static inline void rig_send_i32(struct rig *r, uint8_t command, uint16_t word, int32_t value) {
    const uint32_t v = (uint32_t)value;
    rig_send(r, BYTES(command, 0, (uint8_t)word, (uint8_t)(word >> 8), (uint8_t)v,
                      (uint8_t)(v >> 8), (uint8_t)(v >> 16), (uint8_t)(v >> 24)));
}

static inline void rig_position(struct rig *r, double deg, uint16_t speed_dps) {
    rig_send_i32(r, 0xA4, speed_dps, (int32_t)(deg * 100.0 + (deg < 0.0 ? -0.5 : 0.5)));
}

/// Sends and waits a millisecond; the answer, or an empty frame.
static inline struct can_frame rig_ask(struct rig *r, const uint8_t *bytes) {
    struct can_frame f = {.id = 0};
    r->replies.count = 0;
    rig_send(r, bytes);
    rig_run(r, 1);
    if (!can_rx_queue_pop(&r->replies, &f, NULL)) {
        memset(&f, 0, sizeof f);
    }
    return f;
}

static inline int32_t rig_i32(const struct can_frame *f) {
    return (int32_t)((uint32_t)f->data[4] | (uint32_t)f->data[5] << 8 | (uint32_t)f->data[6] << 16 |
                     (uint32_t)f->data[7] << 24);
}

static inline unsigned rig_errors(struct rig *r) {
    const struct can_frame f = rig_ask(r, BYTES(0x9A));
    CHECK_EQ(f.data[0], 0x9A);
    return f.data[6] | (unsigned)f.data[7] << 8;
}

static inline double rig_deg(const struct rig *r) {
    return r->plant.angle_rad / DEG;
}

static inline double rig_dps(const struct rig *r) {
    return r->plant.rate_rps / DEG;
}

#endif

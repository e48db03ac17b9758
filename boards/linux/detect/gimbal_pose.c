#include "detect/gimbal_pose.h"

#include "degrees.h"

void gimbal_pose_init(struct gimbal_pose *gimbal, const struct controller_config *config,
                      double fixed_focal_mm, double model_focal_mm) {
    *gimbal = (struct gimbal_pose){
        .latency_us = {config->axis[AXIS_PAN].latency_us, config->axis[AXIS_TILT].latency_us},
        .fixed_focal_mm = fixed_focal_mm,
        .model_focal_mm = model_focal_mm};
    pose_history_init(&gimbal->setpoints);
}

/// Where the axis would be at that time if it did what it is told, late. False: that is forgotten.
static bool told_at(const struct gimbal_pose *gimbal, unsigned axis, uint64_t at_us, double *deg) {
    struct camera_pose then;
    const uint32_t asked_us = (uint32_t)at_us - gimbal->latency_us[axis];
    if (pose_history_at(&gimbal->setpoints, asked_us, &then) != POSE_OK) {
        return false;
    }
    *deg = axis == AXIS_PAN ? then.pan_deg : then.tilt_deg;
    return true;
}

static double where(const struct gimbal_pose *gimbal, const struct controller_status *status,
                    unsigned axis, uint64_t at_us) {
    const struct controller_axis_status *at = &status->axis[axis];
    double now_deg, then_deg;
    const bool known = told_at(gimbal, axis, at_us, &now_deg);
    if (!at->measured_known) {
        return known ? now_deg : degrees(at->setpoint_q48);
    }
    const double measured_deg = degrees(at->measured_q48);
    return known && told_at(gimbal, axis, at->measured_us, &then_deg)
               ? measured_deg + now_deg - then_deg
               : measured_deg;
}

struct camera_pose gimbal_pose_tick(struct gimbal_pose *gimbal,
                                    const struct controller_status *status, uint64_t at_us) {
    const struct camera_pose told = {.pan_deg = degrees(status->axis[AXIS_PAN].setpoint_q48),
                                     .tilt_deg = degrees(status->axis[AXIS_TILT].setpoint_q48)};
    if (gimbal->setpoints.count == 0U || gimbal->told_us != status->time_us) {
        pose_history_add(&gimbal->setpoints, (uint32_t)status->time_us, &told);
    }
    gimbal->told_us = status->time_us;
    const double focal_mm =
        status->focal_um != 0U ? (double)status->focal_um * 1e-3 : gimbal->fixed_focal_mm;
    return (struct camera_pose){.pan_deg = where(gimbal, status, AXIS_PAN, at_us),
                                .tilt_deg = where(gimbal, status, AXIS_TILT, at_us),
                                .zoom = focal_mm / gimbal->model_focal_mm};
}

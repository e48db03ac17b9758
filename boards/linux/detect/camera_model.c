#include "detect/camera_model.h"

#include <math.h>
#include <stddef.h>

/// No lens with this model sees farther than 84 degrees from its axis.
#define R2_MOST 90.0

enum { NEWTON_STEPS_MAX = 30 };

struct camera_model camera_model_pinhole(uint32_t width_px, uint32_t height_px, double focal_px) {
    return (struct camera_model){.width_px = width_px,
                                 .height_px = height_px,
                                 .fx_px = focal_px,
                                 .fy_px = focal_px,
                                 .cx_px = (width_px - 1.0) / 2.0,
                                 .cy_px = (height_px - 1.0) / 2.0,
                                 .r2_max = R2_MOST};
}

static double radial_factor(const struct camera_model *model, double r2) {
    return 1.0 + r2 * (model->k1 + r2 * (model->k2 + r2 * model->k3));
}

/// d(r radial) / dr as a function of r2.
static double radial_slope(const struct camera_model *model, double r2) {
    return 1.0 + r2 * (3.0 * model->k1 + r2 * (5.0 * model->k2 + r2 * 7.0 * model->k3));
}

/// The first r2 at which the picture turns back, a little inside of it.
static double one_to_one_r2(const struct camera_model *model) {
    double low = 0.0;
    for (double r2 = 0.001; r2 < R2_MOST; r2 *= 1.02) {
        if (radial_slope(model, r2) > 0.0) {
            low = r2;
            continue;
        }
        double high = r2;
        for (int i = 0; i < 60; i++) {
            const double middle = 0.5 * (low + high);
            *(radial_slope(model, middle) > 0.0 ? &low : &high) = middle;
        }
        return low;
    }
    return R2_MOST;
}

const char *camera_model_check(struct camera_model *model) {
    const double *const numbers[] = {&model->fx_px, &model->fy_px, &model->cx_px,
                                     &model->cy_px, &model->k1,    &model->k2,
                                     &model->p1,    &model->p2,    &model->k3};
    for (unsigned i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (!isfinite(*numbers[i])) {
            return "is not a finite number";
        }
    }
    if (model->width_px == 0U || model->height_px == 0U) {
        return "has no pixels";
    }
    if (!(model->fx_px > 0.0) || !(model->fy_px > 0.0)) {
        return "needs focal lengths above 0";
    }
    model->r2_max = one_to_one_r2(model);
    const double right = model->width_px - 0.5, bottom = model->height_px - 0.5;
    const double border[8][2] = {{-0.5, -0.5},        {right / 2, -0.5}, {right, -0.5},
                                 {right, bottom / 2}, {right, bottom},   {right / 2, bottom},
                                 {-0.5, bottom},      {-0.5, bottom / 2}};
    for (unsigned i = 0; i < 8U; i++) {
        double ray[3];
        if (!camera_model_ray(model, border[i], ray)) {
            return "has a distortion that gives a corner of the picture no direction, or several";
        }
    }
    return NULL;
}

struct camera_model camera_model_zoomed(const struct camera_model *model, double factor) {
    struct camera_model zoomed = *model;
    zoomed.fx_px *= factor;
    zoomed.fy_px *= factor;
    return zoomed;
}

struct camera_model camera_model_resized(const struct camera_model *model, uint32_t width_px,
                                         uint32_t height_px) {
    struct camera_model resized = *model;
    const double across = (double)width_px / model->width_px;
    const double down = (double)height_px / model->height_px;
    resized.width_px = width_px;
    resized.height_px = height_px;
    resized.fx_px *= across;
    resized.fy_px *= down;
    // The corner of the picture, half a pixel before the middle of the first, stays where it is.
    resized.cx_px = (model->cx_px + 0.5) * across - 0.5;
    resized.cy_px = (model->cy_px + 0.5) * down - 0.5;
    return resized;
}

/// Where x, y = tangents to the right and down go, and the derivatives [x'x, x'y, y'x, y'y].
static void distort(const struct camera_model *model, const double at[2], double out[2],
                    double slope[4]) {
    const double x = at[0], y = at[1], r2 = x * x + y * y;
    const double radial = radial_factor(model, r2);
    // d radial / d r2
    const double bend = model->k1 + r2 * (2.0 * model->k2 + r2 * 3.0 * model->k3);
    out[0] = x * radial + 2.0 * model->p1 * x * y + model->p2 * (r2 + 2.0 * x * x);
    out[1] = y * radial + model->p1 * (r2 + 2.0 * y * y) + 2.0 * model->p2 * x * y;
    const double across = 2.0 * x * y * bend + 2.0 * model->p1 * x + 2.0 * model->p2 * y;
    slope[0] = radial + 2.0 * x * x * bend + 2.0 * model->p1 * y + 6.0 * model->p2 * x;
    slope[1] = across;
    slope[2] = across;
    slope[3] = radial + 2.0 * y * y * bend + 6.0 * model->p1 * y + 2.0 * model->p2 * x;
}

bool camera_model_project(const struct camera_model *model, const double direction[3],
                          double pixel[2]) {
    if (!(direction[1] > 0.0)) {
        return false;
    }
    const double at[2] = {direction[0] / direction[1], -direction[2] / direction[1]};
    if (!(at[0] * at[0] + at[1] * at[1] <= model->r2_max)) {
        return false;
    }
    double out[2], slope[4];
    distort(model, at, out, slope);
    pixel[0] = model->fx_px * out[0] + model->cx_px;
    pixel[1] = model->fy_px * out[1] + model->cy_px;
    return true;
}

/// The radius that the radial polynomial sends to `wanted`; it rises up to r2_max, so halving can't
/// miss. Newton's first guess where the distortion is strong.
static double undistorted_radius(const struct camera_model *model, double wanted) {
    double low = 0.0, high = sqrt(model->r2_max);
    for (int i = 0; i < 12; i++) {
        const double middle = 0.5 * (low + high);
        *(middle * radial_factor(model, middle * middle) < wanted ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

bool camera_model_ray(const struct camera_model *model, const double pixel[2],
                      double direction[3]) {
    const double wanted[2] = {(pixel[0] - model->cx_px) / model->fx_px,
                              (pixel[1] - model->cy_px) / model->fy_px};
    const double far = hypot(wanted[0], wanted[1]);
    double at[2] = {wanted[0], wanted[1]};
    if (far > 0.0 && (model->k1 != 0.0 || model->k2 != 0.0 || model->k3 != 0.0)) {
        const double start = undistorted_radius(model, far) / far;
        at[0] *= start;
        at[1] *= start;
    }
    double off = INFINITY;
    for (int i = 0; i < NEWTON_STEPS_MAX && off > 1e-13; i++) {
        double out[2], slope[4];
        distort(model, at, out, slope);
        const double det = slope[0] * slope[3] - slope[1] * slope[2];
        if (!(fabs(det) > 1e-9)) {
            return false;
        }
        const double du = wanted[0] - out[0], dv = wanted[1] - out[1];
        at[0] += (slope[3] * du - slope[1] * dv) / det;
        at[1] += (slope[0] * dv - slope[2] * du) / det;
        off = fabs(du) + fabs(dv);
    }
    const double r2 = at[0] * at[0] + at[1] * at[1];
    if (!(off < 1e-9) || !(r2 <= model->r2_max)) {
        return false;
    }
    const double length = sqrt(1.0 + r2);
    direction[0] = at[0] / length;
    direction[1] = 1.0 / length;
    direction[2] = -at[1] / length;
    return true;
}

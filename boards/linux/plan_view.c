#include "plan.h"

#include "measure.h"

#include "aim/orient.h"
#include "motion/axis.h"
#include "solid/side.h"

#include <float.h>
#include <math.h>

// ---------------------------------------------------------------- the cone

static void narrow(const struct plan *plan, struct plan_view *view) {
    const struct cone_options options = {.workspace = plan->workspace,
                                         .workspace_bytes = plan->workspace_bytes};
    view->at_target = plan->target_count;
    for (uint32_t i = 0; i < plan->target_count; i++) {
        const struct vec3 t = plan->targets[i];
        plan->directions[i] = vec3(t.x - view->at.x, t.y - view->at.y, t.z - view->at.z);
        if (vec3_is_zero(plan->directions[i]) && view->at_target == plan->target_count) {
            view->at_target = i;
        }
    }
    view->cone_status = cone_narrowest(plan->directions, plan->target_count, &options, &view->cone);
    if (view->cone_status == CONE_OK) {
        const long double turn = (long double)view->cone.half_angle_turn64 * 0x1p-64L;
        view->half_angle_rad =
            (double)(turn * 360 / (long double)MEASURE_DEG_PER_RAD) * (1 + 4 * DBL_EPSILON);
        view->pan_deg = measure_pan_deg(view->cone.axis_q30);
        view->tilt_deg = measure_tilt_deg(view->cone.axis_q30);
    }
}

// ---------------------------------------------------------------- the rig

/// Without a rig no lens is longer than for such a cone: the axis' rounding would be seen.
static const double least_half_rad = 1e-5;

static bool axis_reaches(const struct limiter_config *limits, bam32_t angle) {
    const int64_t position = axis_unwrap(angle, 0, limits->min_q48, limits->max_q48);
    return axis_to_bam32(position).bam == angle.bam;
}

static double short_side(double width, double height) {
    return width < height ? width : height;
}

/// The lens as it would stand, and what that means for the cone.
static void set_zoom(const struct plan_camera *camera, struct plan_view *view) {
    const struct lens_config *const lens = &camera->rig->controller.lens;
    const double half_mm = short_side(lens->sensor_width_um, lens->sensor_height_um) / 2000.0;
    const double without_margin_mm = half_mm / tan(view->half_angle_rad),
                 wanted_mm = without_margin_mm / (1 + lens->margin_q16 * 0x1p-16);
    double least_mm = camera->rig->fixed_focal_mm, most_mm = least_mm;
    if (lens->point_count != 0U) {
        least_mm = lens->point[0].focal_um / 1000.0;
        most_mm = lens->point[lens->point_count - 1U].focal_um / 1000.0;
        view->focal_mm = lens_focal_um(lens, view->cone.half_angle_bam32) / 1000.0;
    } else {
        view->focal_mm = least_mm;
    }
    view->zoom = without_margin_mm < least_mm ? PLAN_ZOOM_TOO_WIDE
                 : wanted_mm < least_mm       ? PLAN_ZOOM_TIGHT
                 : wanted_mm > most_mm        ? PLAN_ZOOM_SMALL
                                              : PLAN_ZOOM_FITS;
    view->focal_px = view->focal_mm * 1000.0 / lens->sensor_width_um * camera->width_px;
}

static void set_rig(const struct plan_camera *camera, struct plan_view *view) {
    if (camera->rig == NULL) {
        view->reachable = true;
        view->zoom = PLAN_ZOOM_FITS;
        const double half_rad = fmax(view->half_angle_rad, least_half_rad);
        view->focal_px = short_side(camera->width_px, camera->height_px) / 2 / tan(half_rad);
        return;
    }
    struct mount_joints joints;
    const struct controller_axis_config *const axis = camera->rig->controller.axis;
    const bool has_pan = mount_solve(&camera->mount, view->cone.axis_q30, &joints);
    view->reachable = (!has_pan || axis_reaches(&axis[AXIS_PAN].limits, joints.pan)) &&
                      axis_reaches(&axis[AXIS_TILT].limits, joints.tilt);
    set_zoom(camera, view);
}

// ---------------------------------------------------------------- the picture

static void project(const struct plan *plan, const struct plan_view *view) {
    const struct vec3 a = view->cone.axis_q30;
    const struct orient_axes axes = orient_axes(a, vec3(0, 0, 1));
    for (uint32_t i = 0; i < plan->target_count; i++) {
        const struct vec3 d = plan->directions[i];
        const double scale = view->focal_px / (double)vec3_dot_unit(a, d);
        plan->image[2U * i] = (double)vec3_dot_unit(axes.right_q30, d) * scale;
        plan->image[2U * i + 1U] = (double)vec3_dot_unit(axes.up_q30, d) * scale;
    }
}

static void find_pair(const struct plan *plan, struct plan_view *view) {
    const double *const p = plan->image;
    double best = INFINITY;
    for (uint32_t i = 0; i < plan->target_count; i++) {
        for (uint32_t j = i + 1U; j < plan->target_count; j++) {
            const double x = p[2U * j] - p[2U * i], y = p[2U * j + 1U] - p[2U * i + 1U];
            if (x * x + y * y < best) {
                best = x * x + y * y;
                view->pair[0] = i;
                view->pair[1] = j;
            }
        }
    }
    view->pair_px = sqrt(best);
}

/// The least height of a triangle of three targets. Those on one line in space have none anywhere
/// and don't count.
static void find_triple(const struct plan *plan, struct plan_view *view) {
    const double *const p = plan->image;
    double best = INFINITY;
    for (uint32_t i = 0; i < plan->target_count; i++) {
        for (uint32_t j = i + 1U; j < plan->target_count; j++) {
            const double ax = p[2U * j] - p[2U * i], ay = p[2U * j + 1U] - p[2U * i + 1U],
                         a2 = ax * ax + ay * ay;
            for (uint32_t k = j + 1U; k < plan->target_count; k++) {
                const double bx = p[2U * k] - p[2U * i], by = p[2U * k + 1U] - p[2U * i + 1U],
                             b2 = bx * bx + by * by, cx = bx - ax, cy = by - ay,
                             c2 = cx * cx + cy * cy, longer = a2 > b2 ? a2 : b2,
                             longest = longer > c2 ? longer : c2, area = ax * by - ay * bx;
                if (area * area < best * longest &&
                    !side_collinear(plan->targets[i], plan->targets[j], plan->targets[k])) {
                    best = area * area / longest;
                    view->triple[0] = i;
                    view->triple[1] = j;
                    view->triple[2] = k;
                }
            }
        }
    }
    view->triple_px = sqrt(best);
}

uint32_t plan_hidden(struct plan *plan, struct vec3 at) {
    return plan->text == NULL
               ? 0U
               : plan_scene_hidden(&plan->scene, at, plan->targets, plan->target_count,
                                   plan->hidden, plan->hidden_by);
}

void plan_glance(struct plan *plan, struct vec3 at, struct plan_view *out) {
    *out = (struct plan_view){.at = at,
                              .pair_px = INFINITY,
                              .triple_px = INFINITY,
                              .place = {at.x * plan->grid, at.y * plan->grid, at.z * plan->grid}};
    narrow(plan, out);
    if (out->cone_status != CONE_OK) {
        return;
    }
    set_rig(&plan->camera, out);
    if (plan->target_count > 1U) {
        project(plan, out);
        find_pair(plan, out);
    }
    if (plan->planes) {
        find_triple(plan, out);
    }
    out->margin_px = out->pair_px < out->triple_px ? out->pair_px : out->triple_px;
    out->hidden_count = plan_hidden(plan, at);
    out->usable = out->reachable && out->zoom != PLAN_ZOOM_TOO_WIDE && out->hidden_count == 0U;
}

// ---------------------------------------------------------------- margins in space

static long double i256_to_real(struct i256 a) {
    long double value = 0;
    for (int i = 3; i >= 0; i--) {
        value = value * 0x1p64L + (long double)a.word[i];
    }
    return value;
}

/// A squared distance in the grid as centimetres.
static double margin_cm(const struct plan *plan, const struct viewpoint_margin *margin) {
    if (i128_sign(margin->denominator) == 0) {
        return INFINITY;
    }
    const long double squared =
        i256_to_real(margin->numerator) / i256_to_real(i256_from_i128(margin->denominator));
    return (double)(sqrtl(squared) * (long double)plan->grid * (long double)plan->unit_cm);
}

/// What is below the last digits of the place is none.
static double clean(const struct plan *plan, long double x) {
    return fabsl(x) < 1e-9L ? 0 : (double)(x * (long double)plan->grid);
}

static void set_line_foot(const struct plan *plan, struct plan_view *view) {
    const struct vec3 a = plan->targets[view->margins.line.target[0]],
                      b = plan->targets[view->margins.line.target[1]];
    const struct vec3_i64 d = side_between(a, b), away = side_between(a, view->at);
    const long double part = (long double)(d.x * away.x + d.y * away.y + d.z * away.z) /
                             (long double)(d.x * d.x + d.y * d.y + d.z * d.z);
    view->line_foot[0] = clean(plan, a.x + part * (long double)d.x);
    view->line_foot[1] = clean(plan, a.y + part * (long double)d.y);
    view->line_foot[2] = clean(plan, a.z + part * (long double)d.z);
}

static void set_plane_foot(const struct plan *plan, struct plan_view *view) {
    const uint32_t *const i = view->margins.plane.target;
    const struct vec3 a = plan->targets[i[0]], b = plan->targets[i[1]], c = plan->targets[i[2]];
    const struct vec3 ab = vec3(b.x - a.x, b.y - a.y, b.z - a.z),
                      ac = vec3(c.x - a.x, c.y - a.y, c.z - a.z);
    const struct vec3_i64 n = vec3_cross(ab, ac), away = side_between(a, view->at);
    const long double nx = (long double)n.x, ny = (long double)n.y, nz = (long double)n.z;
    const long double part =
        (nx * (long double)away.x + ny * (long double)away.y + nz * (long double)away.z) /
        (nx * nx + ny * ny + nz * nz);
    view->plane_foot[0] = clean(plan, (long double)view->at.x - part * nx);
    view->plane_foot[1] = clean(plan, (long double)view->at.y - part * ny);
    view->plane_foot[2] = clean(plan, (long double)view->at.z - part * nz);
}

enum exit_status plan_look(struct plan *plan, struct vec3 at, struct plan_view *out) {
    plan_glance(plan, at, out);
    const enum viewpoint_status status =
        viewpoint_margins(plan->targets, plan->target_count, at, plan->planes, &out->margins);
    if (status == VIEWPOINT_AT_TARGET) {
        return EXIT_STATUS_OK;
    }
    if (status != VIEWPOINT_OK) {
        message_command("plan", "internal failure %d", (int)status);
        return EXIT_STATUS_FAILURE;
    }
    out->lineup_known = lineup_find(plan->directions, plan->target_count, true, plan->workspace,
                                    plan->workspace_bytes, &out->lineup) == LINEUP_OK;
    out->line_cm = margin_cm(plan, &out->margins.line);
    out->plane_cm = margin_cm(plan, &out->margins.plane);
    out->margin_cm = out->line_cm < out->plane_cm ? out->line_cm : out->plane_cm;
    if (isfinite(out->line_cm)) {
        set_line_foot(plan, out);
    }
    if (isfinite(out->plane_cm)) {
        set_plane_foot(plan, out);
    }
    return EXIT_STATUS_OK;
}

#include "scene_render.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct camera {
    struct vec3 eye;
    double axis[3][3]; ///< right, ahead, up
    struct vec3 axis_q30[3];
    double focal_px, width, height, unit;
};

struct render {
    const struct scene_render_options *options;
    struct scene_drawn *drawn;
    struct drawing *drawing;
    struct scene_render_result *result;
    struct camera camera;
    struct vec3 *targets;
    uint32_t target_count;
};

// ---------------------------------------------------------------- camera

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static bool normalise(double v[3]) {
    const double length = sqrt(dot(v, v));
    for (int i = 0; i < 3; i++) {
        v[i] /= length;
    }
    return isfinite(length) && length > 0;
}

static struct vec3 to_q30(const double v[3]) {
    return vec3((int32_t)lrint(v[0] * 0x1p30), (int32_t)lrint(v[1] * 0x1p30),
                (int32_t)lrint(v[2] * 0x1p30));
}

/// Turns the camera; looking along up, right is +x.
static void turn_camera(struct camera *c, const double ahead[3], const double up[3]) {
    static const double fallback[2][3] = {{1, 0, 0}, {0, 1, 0}};
    double *const right = c->axis[0];
    memcpy(c->axis[1], ahead, sizeof c->axis[1]);
    cross(ahead, up, right);
    for (int i = 0; i < 2 && dot(right, right) < 1e-18 * dot(up, up); i++) {
        const double along = dot(fallback[i], ahead);
        for (int k = 0; k < 3; k++) {
            right[k] = fallback[i][k] - along * ahead[k];
        }
    }
    (void)normalise(right);
    cross(right, ahead, c->axis[2]);
    for (int i = 0; i < 3; i++) {
        c->axis_q30[i] = to_q30(c->axis[i]);
    }
}

static double depth_of(const struct camera *c, const double p[3]) {
    return dot(c->axis[1], p);
}

/// Pixels of a direction with depth above 0.
static void project(const struct camera *c, const double p[3], double out[2]) {
    const double depth = depth_of(c, p);
    out[0] = c->width / 2 + c->focal_px * dot(c->axis[0], p) / depth;
    out[1] = c->height / 2 - c->focal_px * dot(c->axis[2], p) / depth;
}

static void from_eye(const struct camera *c, struct vec3 place, double out[3]) {
    out[0] = (double)place.x - c->eye.x;
    out[1] = (double)place.y - c->eye.y;
    out[2] = (double)place.z - c->eye.z;
}

// ---------------------------------------------------------------- lines

/// A line between directions; what is nearer than a millionth of the farther end is cut off.
static void draw_line(struct render *r, const double a[3], const double b[3],
                      enum drawing_pen pen) {
    const struct camera *const c = &r->camera;
    double end[2][3], px[2][2];
    memcpy(end[0], a, sizeof end[0]);
    memcpy(end[1], b, sizeof end[1]);
    const double depth[2] = {depth_of(c, a), depth_of(c, b)};
    const double least = 1e-6 * fmax(depth[0], depth[1]);
    if (!(least > 0)) {
        return;
    }
    for (int i = 0; i < 2; i++) {
        const double t = (least - depth[i]) / (depth[1 - i] - depth[i]);
        for (int k = 0; k < 3 && depth[i] < least; k++) {
            end[i][k] += t * ((i == 0 ? b : a)[k] - end[i][k]);
        }
        project(c, end[i], px[i]);
    }
    if (drawing_clip(r->drawing, px[0], px[1])) {
        drawing_line(r->drawing, (struct drawing_line){(float)px[0][0], (float)px[0][1],
                                                       (float)px[1][0], (float)px[1][1], pen});
    }
}

static void add_segment(void *context, const struct hidden_segment *segment) {
    struct render *const r = context;
    const struct shape_edge *const edge = &r->drawn->set.edges[segment->edge];
    const double t[2] = {(double)fraction_q62(segment->part.from) * 0x1p-62,
                         (double)fraction_q62(segment->part.to) * 0x1p-62};
    double a[3], b[3], end[2][3];
    from_eye(&r->camera, r->drawn->set.vertices[edge->from], a);
    from_eye(&r->camera, r->drawn->set.vertices[edge->to], b);
    for (int i = 0; i < 3; i++) {
        end[0][i] = a[i] + t[0] * (b[i] - a[i]);
        end[1][i] = a[i] + t[1] * (b[i] - a[i]);
    }
    draw_line(r, end[0], end[1], PEN_EDGE);
    r->result->segments++;
}

static void draw_lines(struct render *r) {
    struct hidden *const h = &r->drawn->hidden;
    const struct hidden_sink sink = {add_segment, r};
    if (r->options->levine) {
        separate_look(&r->drawn->separate, r->camera.eye);
        hidden_levine(h, &r->drawn->separate, &sink, &r->result->counters);
    } else {
        hidden_clip(h, &sink);
    }
    for (uint32_t e = 0; e < r->drawn->set.edge_count; e++) {
        r->result->edges += h->edge_class[e] != HIDDEN_BACK ? 1U : 0U;
    }
}

// ---------------------------------------------------------------- targets and cone

static bool is_seen(const struct scene_drawn *d, struct vec3 eye, struct vec3 place) {
    const struct vec3 p = sight_from_eye(eye, place);
    for (uint32_t i = 0; i < d->hidden.sight.piece_count; i++) {
        if (sight_hides(&d->hidden.sight, &d->hidden.sight.pieces[i], p)) {
            return false;
        }
    }
    return true;
}

/// The narrowest cone of the targets in sight. Returns whether a picture can hold it.
static bool find_cone(struct render *r) {
    struct vec3 *const seen = malloc((r->target_count + 1U) * sizeof *seen);
    void *const workspace = malloc(CONE_WORKSPACE_BYTES(r->target_count + 1U));
    struct scene_render_result *const out = r->result;
    struct cone_result cone;
    for (uint32_t i = 0; i < r->target_count && seen != NULL; i++) {
        const struct vec3 p = sight_from_eye(r->camera.eye, r->targets[i]);
        if (is_seen(r->drawn, r->camera.eye, r->targets[i]) && !vec3_is_zero(p)) {
            seen[out->targets_seen++] = p;
        }
    }
    const struct cone_options options = {.lengths = CONE_LENGTHS_ANY,
                                         .workspace = workspace,
                                         .workspace_bytes =
                                             CONE_WORKSPACE_BYTES(r->target_count + 1U)};
    const bool ok = seen != NULL && workspace != NULL &&
                    cone_narrowest(seen, out->targets_seen, &options, &cone) == CONE_OK;
    if (ok) {
        const struct vec3 axis = cone.axis_q30;
        const double a[3] = {axis.x * 0x1p-30, axis.y * 0x1p-30, axis.z * 0x1p-30};
        memcpy(out->cone_axis, a, sizeof a);
        out->cone_half_angle_deg = (double)cone.half_angle_turn64 * 0x1p-64 * 360.0;
        out->cone = out->cone_half_angle_deg < 90.0;
    }
    free(seen);
    free(workspace);
    return out->cone;
}

static void draw_targets(struct render *r) {
    for (uint32_t i = 0; i < r->target_count; i++) {
        double p[3], px[2];
        from_eye(&r->camera, r->targets[i], p);
        if (depth_of(&r->camera, p) <= 0) {
            continue;
        }
        const bool seen = is_seen(r->drawn, r->camera.eye, r->targets[i]);
        project(&r->camera, p, px);
        if (px[0] >= 0 && px[0] <= r->camera.width && px[1] >= 0 && px[1] <= r->camera.height) {
            drawing_dot(r->drawing, (struct drawing_dot){(float)px[0], (float)px[1], 3.0F,
                                                         seen ? PEN_TARGET : PEN_LOST, seen});
        }
    }
}

/// The cone's rim, as a chain of 128 lines, and its axis.
static void draw_cone(struct render *r) {
    const double *const axis = r->result->cone_axis;
    const double half = r->result->cone_half_angle_deg * M_PI / 180.0;
    double u[3], v[3], last[3] = {0, 0, 0};
    const double any[3] = {fabs(axis[0]) < 0.6, fabs(axis[0]) >= 0.6, 0};
    cross(axis, any, u);
    (void)normalise(u);
    cross(axis, u, v);
    for (int i = 0; i <= 128 && half > 0; i++) {
        const double turn = 2 * M_PI * i / 128;
        double p[3];
        for (int k = 0; k < 3; k++) {
            p[k] = cos(half) * axis[k] + sin(half) * (cos(turn) * u[k] + sin(turn) * v[k]);
        }
        if (i != 0) {
            draw_line(r, last, p, PEN_CONE);
        }
        memcpy(last, p, sizeof last);
    }
    if (depth_of(&r->camera, axis) > 0) {
        double px[2];
        project(&r->camera, axis, px);
        drawing_dot(r->drawing,
                    (struct drawing_dot){(float)px[0], (float)px[1], 2.0F, PEN_CONE, true});
    }
}

/// The border of the picture, and a cross where the camera looks.
static void draw_frame(struct render *r) {
    const float w = (float)r->camera.width - 1.0F, h = (float)r->camera.height - 1.0F;
    const float x = (float)r->camera.width / 2.0F, y = (float)r->camera.height / 2.0F;
    const struct drawing_line lines[6] = {
        {1, 1, w, 1, PEN_FRAME}, {w, 1, w, h, PEN_FRAME},         {w, h, 1, h, PEN_FRAME},
        {1, h, 1, 1, PEN_FRAME}, {x - 8, y, x + 8, y, PEN_FRAME}, {x, y - 8, x, y + 8, PEN_FRAME}};
    for (int i = 0; i < 6; i++) {
        drawing_line(r->drawing, lines[i]);
    }
}

// ---------------------------------------------------------------- all of it

/// The scene's own points, and those of the file; those too far away are told.
static enum exit_status read_targets(struct render *r) {
    const struct scene_render_options *const o = r->options;
    struct points points = {0};
    if (o->targets != NULL) {
        const struct points_format format = {.input = POINTS_XYZ, .places = true};
        const enum exit_status status = points_read(o->targets, &format, &points);
        if (status != EXIT_STATUS_OK) {
            points_free(&points);
            return status;
        }
    }
    const uint32_t own = r->drawn->point_count;
    r->targets = malloc(((size_t)own + points.count + 1U) * sizeof *r->targets);
    enum exit_status status = r->targets != NULL ? EXIT_STATUS_OK : EXIT_STATUS_FAILURE;
    for (uint32_t i = 0; i < own && r->targets != NULL; i++) {
        r->targets[r->target_count++] = r->drawn->points[i];
    }
    for (uint32_t i = 0; i < points.count && status == EXIT_STATUS_OK; i++) {
        const long double scale = points.unit / (long double)r->camera.unit;
        const long double at[3] = {points.directions[i].x * scale, points.directions[i].y * scale,
                                   points.directions[i].z * scale};
        const long double most = SHAPE_COORDINATE_MAX;
        if (fabsl(at[0]) > most || fabsl(at[1]) > most || fabsl(at[2]) > most) {
            message_at(o->targets, points.lines[i], "the target is too far from the scene");
            status = EXIT_STATUS_USAGE;
            break;
        }
        r->targets[r->target_count++] =
            vec3((int32_t)lroundl(at[0]), (int32_t)lroundl(at[1]), (int32_t)lroundl(at[2]));
    }
    points_free(&points);
    r->result->targets = r->target_count;
    return status;
}

/// Everything in front of the viewer, as what is beside the picture may hide a target, too; or,
/// where the camera is still to be aimed, everything, in the finest description.
static struct view view_of(const struct camera *c, bool aimed) {
    const double focal = fmin(fmax(c->focal_px * 256.0, 1.0), 0x1p24);
    struct view view = {.eye = c->eye, .focal_px_q8 = (uint32_t)focal};
    for (int i = 0; i < 4 && aimed; i++) {
        view.inward[i] = c->axis_q30[1];
    }
    view.ahead = view.inward[0];
    return view;
}

static enum exit_status place_camera(struct render *r, const struct tree *tree, const char *file) {
    const struct scene_render_options *const o = r->options;
    struct camera *const c = &r->camera;
    double ahead[3], at[3];
    memcpy(&c->unit, tree->header->unit_double, sizeof c->unit);
    for (int i = 0; i < 3; i++) {
        at[i] = o->viewpoint[i] / c->unit;
        ahead[i] = o->aim_given ? o->aim[i] - o->viewpoint[i] : (i == 1 ? 1.0 : 0.0);
        if (!(fabs(at[i]) <= TREE_COORDINATE_MAX)) {
            message_at(file, 0, "the viewpoint is more than %g from the origin of this scene",
                       TREE_COORDINATE_MAX * c->unit);
            return EXIT_STATUS_USAGE;
        }
    }
    if (!normalise(ahead)) {
        message_at(file, 0, "the camera can't look at the viewpoint itself");
        return EXIT_STATUS_USAGE;
    }
    c->eye = vec3((int32_t)lrint(at[0]), (int32_t)lrint(at[1]), (int32_t)lrint(at[2]));
    c->width = o->width;
    c->height = o->height;
    c->focal_px = c->width / 2 / tan(o->fov_deg * M_PI / 360.0);
    turn_camera(c, ahead, o->up);
    return EXIT_STATUS_OK;
}

static int32_t half_q16(double px, double focal_px) {
    const double tangent = px / 2 / focal_px * 65536.0;
    return (int32_t)fmin(ceil(tangent) + 1, 0x1p27);
}

/// Shadows for the eye; without a border, as a target may be hidden by what is beside the picture.
static void look(struct render *r, bool border) {
    const struct camera *const c = &r->camera;
    const struct hidden_camera camera = {c->eye,
                                         c->axis_q30[0],
                                         c->axis_q30[1],
                                         c->axis_q30[2],
                                         border ? half_q16(c->width, c->focal_px) : 0,
                                         border ? half_q16(c->height, c->focal_px) : 0};
    hidden_look(&r->drawn->hidden, &camera);
}

static enum exit_status draw_all(struct render *r, const struct tree *tree, const char *file) {
    const struct view view = view_of(&r->camera, r->options->aim_given);
    enum exit_status status = scene_drawn_gather(r->drawn, tree, &view, file);
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_check(r->drawn, tree, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_open(r->drawn, tree, file, r->options->levine);
    }
    if (status == EXIT_STATUS_OK) {
        status = read_targets(r);
    }
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    look(r, false);
    if (find_cone(r) && !r->options->aim_given) {
        turn_camera(&r->camera, r->result->cone_axis, r->options->up);
    }
    draw_targets(r);
    look(r, true);
    draw_lines(r);
    draw_frame(r);
    if (r->result->cone) {
        draw_cone(r);
    }
    r->result->objects = r->drawn->set.object_count;
    r->result->memory_bytes = r->drawn->bytes;
    return EXIT_STATUS_OK;
}

enum exit_status scene_render(const struct tree *tree, const char *file,
                              const struct scene_render_options *options, struct drawing *drawing,
                              struct scene_render_result *result) {
    struct scene_drawn drawn = {.point_count = 0};
    struct render render = {
        .options = options, .drawn = &drawn, .drawing = drawing, .result = result};
    *drawing = (struct drawing){.width = options->width, .height = options->height};
    *result = (struct scene_render_result){.objects = 0};
    enum exit_status status = place_camera(&render, tree, file);
    if (status == EXIT_STATUS_OK) {
        status = draw_all(&render, tree, file);
    }
    free(render.targets);
    scene_drawn_free(&drawn);
    return status;
}

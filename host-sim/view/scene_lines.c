#include "view/scene_lines.h"

#include "scene/hidden.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct lines {
    const struct shape_set *set;
    const struct sim_view *view;
    struct vec3 eye;
    double half_mm[2];
    struct report_line *lines;
    size_t count, room;
    bool failed;
};

static double along(struct vec3 axis_q30, const double p[3]) {
    return (axis_q30.x * p[0] + axis_q30.y * p[1] + axis_q30.z * p[2]) * 0x1p-30;
}

/// Cuts a line to the sensor's surroundings. False: nothing is left.
static bool cut(const struct lines *l, double from[2], double to[2]) {
    double low = 0, high = 1;
    const double start[2] = {from[0], from[1]}, way[2] = {to[0] - from[0], to[1] - from[1]};
    for (int axis = 0; axis < 2; axis++) {
        const double a = (-l->half_mm[axis] - start[axis]) / way[axis],
                     b = (l->half_mm[axis] - start[axis]) / way[axis];
        if (way[axis] == 0.0) {
            low = fabs(start[axis]) > l->half_mm[axis] ? 2 : low;
            continue;
        }
        low = fmax(low, fmin(a, b));
        high = fmin(high, fmax(a, b));
    }
    for (int axis = 0; axis < 2; axis++) {
        from[axis] = start[axis] + low * way[axis];
        to[axis] = start[axis] + high * way[axis];
    }
    return low < high;
}

static void add(struct lines *l, const double from[2], const double to[2]) {
    if (l->count == l->room) {
        const size_t wanted = l->room == 0U ? 256U : 2U * l->room;
        struct report_line *const grown = realloc(l->lines, wanted * sizeof *grown);
        if (grown == NULL) {
            l->failed = true;
            return;
        }
        l->lines = grown;
        l->room = wanted;
    }
    l->lines[l->count++] = (struct report_line){from[0], from[1], to[0], to[1]};
}

static void take_segment(void *context, const struct hidden_segment *segment) {
    struct lines *const l = context;
    const struct shape_edge *const edge = &l->set->edges[segment->edge];
    const struct vec3 a = l->set->vertices[edge->from], b = l->set->vertices[edge->to];
    const double t[2] = {(double)fraction_q62(segment->part.from) * 0x1p-62,
                         (double)fraction_q62(segment->part.to) * 0x1p-62};
    double p[2][3], depth[2], px[2][2];
    for (int i = 0; i < 2; i++) {
        p[i][0] = a.x + t[i] * ((double)b.x - a.x) - l->eye.x;
        p[i][1] = a.y + t[i] * ((double)b.y - a.y) - l->eye.y;
        p[i][2] = a.z + t[i] * ((double)b.z - a.z) - l->eye.z;
        depth[i] = along(l->view->ahead_q30, p[i]);
    }
    const double least = 1e-3 * fmax(depth[0], depth[1]); // what is nearer is beside the picture
    if (!(least > 0.0)) {
        return;
    }
    for (int i = 0; i < 2; i++) {
        const double s = depth[i] < least ? (least - depth[i]) / (depth[1 - i] - depth[i]) : 0.0;
        double q[3];
        for (int k = 0; k < 3; k++) {
            q[k] = p[i][k] + s * (p[1 - i][k] - p[i][k]);
        }
        const double scale = l->view->focal_mm / along(l->view->ahead_q30, q);
        px[i][0] = scale * along(l->view->right_q30, q);
        px[i][1] = scale * along(l->view->up_q30, q);
    }
    if (cut(l, px[0], px[1])) {
        add(l, px[0], px[1]);
    }
}

/// A copy of the shapes with each group where it is.
static bool move_shapes(const struct sim *sim, struct shape_set *out) {
    const struct sim_obstacles *const obstacles = sim->config.obstacles;
    const struct shape_set *const from = obstacles->occlusion.shapes;
    const struct units units = obstacles->occlusion.units;
    *out = *from;
    out->vertices = malloc((from->vertex_count + 1U) * sizeof *out->vertices);
    out->planes = malloc((from->face_count + 1U) * sizeof *out->planes);
    if (out->vertices == NULL || out->planes == NULL) {
        return false;
    }
    for (uint32_t i = 0; i < from->object_count; i++) {
        const struct shape_object *const o = &from->objects[i];
        const uint32_t group =
            obstacles->occlusion.group == NULL ? 0U : obstacles->occlusion.group[i];
        const struct vec3_i64 um = sim_group_offset_um(obstacles, group, sim->time_us);
        const struct vec3 by =
            vec3((int32_t)units_from_um(units, um.x), (int32_t)units_from_um(units, um.y),
                 (int32_t)units_from_um(units, um.z));
        for (uint32_t v = o->first_vertex; v < o->first_vertex + o->vertex_count; v++) {
            const struct vec3 p = from->vertices[v];
            out->vertices[v] = vec3(p.x + by.x, p.y + by.y, p.z + by.z);
        }
        for (uint32_t f = o->first_face; f < o->first_face + o->face_count; f++) {
            const struct shape_plane plane = from->planes[f];
            out->planes[f] = (struct shape_plane){
                plane.normal, i128_add(plane.offset, vec3_i64_dot_vec3(plane.normal, by))};
        }
    }
    return true;
}

static bool draw(struct lines *l) {
    const size_t bytes = hidden_workspace_bytes(l->set);
    void *const workspace = malloc(bytes);
    struct hidden hidden;
    const struct hidden_sink sink = {take_segment, l};
    const bool ok =
        workspace != NULL && hidden_open(&hidden, l->set, workspace, bytes) == HIDDEN_OK;
    if (ok) {
        const struct hidden_camera camera = {
            l->eye, l->view->right_q30, l->view->ahead_q30, l->view->up_q30, 0, 0};
        hidden_look(&hidden, &camera);
        hidden_clip(&hidden, &sink);
    }
    free(workspace);
    return ok && !l->failed;
}

struct report_line *scene_lines(const struct sim *sim, const struct sim_view *view,
                                double sensor_width_mm, double sensor_height_mm, size_t *count) {
    const struct sim_obstacles *const obstacles = sim->config.obstacles;
    *count = 0;
    if (obstacles == NULL) {
        return NULL;
    }
    const struct vec3_i64 um = obstacles->occlusion.viewpoint_um;
    const struct units units = obstacles->occlusion.units;
    struct shape_set moved;
    struct lines l = {.set = &moved,
                      .view = view,
                      .eye = vec3((int32_t)units_from_um(units, um.x),
                                  (int32_t)units_from_um(units, um.y),
                                  (int32_t)units_from_um(units, um.z)),
                      .half_mm = {sensor_width_mm, sensor_height_mm}};
    const bool ok = move_shapes(sim, &moved) && draw(&l);
    free(moved.vertices);
    free(moved.planes);
    if (!ok) {
        free(l.lines);
        *count = 1;
        return NULL;
    }
    *count = l.count;
    return l.lines;
}

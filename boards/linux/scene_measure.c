#include "scene_measure.h"

#include <math.h>

struct place {
    double middle[3], radius; ///< of the sphere around the box of everything
};

static struct place place_of(const struct shape_set *set) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    struct place place = {{0, 0, 0}, 0};
    for (uint32_t v = 0; v < set->vertex_count; v++) {
        const double at[3] = {set->vertices[v].x, set->vertices[v].y, set->vertices[v].z};
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
    for (int k = 0; k < 3 && set->vertex_count != 0U; k++) {
        place.middle[k] = (low[k] + high[k]) / 2;
        place.radius += (high[k] - low[k]) * (high[k] - low[k]) / 4;
    }
    place.radius = sqrt(place.radius);
    return place;
}

static struct vec3 rounded(double x, double y, double z) {
    return vec3((int32_t)lrint(x), (int32_t)lrint(y), (int32_t)lrint(z));
}

/// At whole quarter turns exactly 0 and 1, so that faces seen from the edge are counted as such.
static double sine(unsigned degrees) {
    return degrees % 180U == 0U ? 0.0 : sin(degrees * (M_PI / 180.0));
}

static struct hidden_camera camera_at(const struct place *place, enum scene_turn turn,
                                      unsigned degrees, double distance) {
    const double s = sine(degrees), c = sine(degrees + 90U), one = 0x1p30;
    const double away = distance * place->radius;
    const double *const m = place->middle;
    if (turn == SCENE_YAW) {
        return (struct hidden_camera){.eye = rounded(m[0] - away * s, m[1] - away * c, m[2]),
                                      .right = rounded(one * c, -one * s, 0),
                                      .ahead = rounded(one * s, one * c, 0),
                                      .up = rounded(0, 0, one)};
    }
    return (struct hidden_camera){.eye = rounded(m[0], m[1] - away * c, m[2] - away * s),
                                  .right = rounded(one, 0, 0),
                                  .ahead = rounded(0, one * c, one * s),
                                  .up = rounded(0, -one * s, one * c)};
}

static void count_segment(void *context, const struct hidden_segment *segment) {
    struct scene_count *const count = context;
    (void)segment;
    count->segments++;
}

static void count_views(struct scene_drawn *d, double distance, struct scene_measure *out) {
    const struct place place = place_of(&d->set);
    for (int turn = 0; turn < (int)SCENE_TURNS; turn++) {
        for (unsigned degrees = 0; degrees < SCENE_TURN_VIEWS; degrees++) {
            struct scene_count *const count = &out->view[turn][degrees];
            const struct hidden_sink sink = {count_segment, count};
            const struct hidden_camera camera =
                camera_at(&place, (enum scene_turn)turn, degrees, distance);
            *count = (struct scene_count){.segments = 0};
            hidden_look(&d->hidden, &camera);
            separate_look(&d->separate, camera.eye);
            hidden_levine(&d->hidden, &d->separate, &sink, &count->counters);
        }
    }
}

static bool is_within_reach(const struct shape_set *set, double distance) {
    const struct place place = place_of(set);
    double most = 0;
    for (int k = 0; k < 3; k++) {
        most = fmax(most, fabs(place.middle[k]));
    }
    return most + distance * place.radius <= TREE_COORDINATE_MAX;
}

enum exit_status scene_measure(const struct tree *tree, const char *file, double distance,
                               struct scene_measure *out) {
    // Without a direction to look along every object is as large as can be.
    const struct tree_node *const root = tree->header->node_count != 0U ? tree->nodes : NULL;
    const struct view view = {.eye = root != NULL ? vec3(root->x, root->y, root->z) : vec3(0, 0, 0),
                              .focal_px_q8 = UINT32_C(1) << 24};
    struct scene_drawn drawn = {.point_count = 0};
    enum exit_status status = scene_drawn_gather(&drawn, tree, &view, file);
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_check(&drawn, tree, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = scene_drawn_open(&drawn, tree, file, true);
    }
    if (status == EXIT_STATUS_OK && !is_within_reach(&drawn.set, distance)) {
        message_at(file, 0, "--distance: the eye would be beyond what this scene's units reach");
        status = EXIT_STATUS_USAGE;
    }
    if (status == EXIT_STATUS_OK) {
        count_views(&drawn, distance, out);
        out->objects = drawn.set.object_count;
        out->planes = drawn.separate.plane_count;
    }
    scene_drawn_free(&drawn);
    return status;
}

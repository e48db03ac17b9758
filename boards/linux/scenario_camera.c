#include "scenario_camera.h"

#include "detect/tags.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LOOKS_LAMPS, LOOKS_TAGS, LOOKS_PEOPLE };
static const char *const looks[] = {"lamps", "tags", "people", NULL};

/// Where targets are drawn: only their direction is known, and only it matters.
#define DISTANCE_M 10.0

/// A texture's cells.
#define CELLS_MAX (TAGS_CELLS_MAX * TAGS_CELLS_MAX)

#define KEY(member) .offset = offsetof(struct scenario_camera_keys, member)
const struct ini_key scenario_camera_keys[SCENARIO_CAMERA_KEY_COUNT] = {
    {.name = "looks",
     .type = INI_CHOICE,
     .fallback = "lamps",
     .choices = looks,
     KEY(looks),
     .help = "what the targets look like; the rig's detect must fit"},
    {.name = "size_deg",
     .type = INI_DECIMAL,
     .fallback = "1.5",
     .min = "0.01",
     .max = "40",
     .numerator = 1000000,
     KEY(size_udeg),
     .help = "how wide they are, as seen from the gimbal"},
    {.name = "fps",
     .type = INI_DECIMAL,
     .fallback = "20",
     .min = "0.1",
     .max = "1000",
     .numerator = 1000,
     KEY(fps_milli),
     .help = "frames a second"},
    {.name = "latency_ms",
     .type = INI_DECIMAL,
     .fallback = "40",
     .min = "0",
     .max = "1000",
     .numerator = 1000,
     KEY(latency_us),
     .help = "from exposure to what the detectors say of it"},
    {.name = "noise_luma",
     .type = INI_DECIMAL,
     .fallback = "3",
     .min = "0",
     .max = "100",
     .numerator = 1000,
     KEY(noise_milli),
     .help = "of the sensor, standard deviation in grey levels"},
    {.name = "blur_px",
     .type = INI_DECIMAL,
     .fallback = "0.8",
     .min = "0",
     .max = "4",
     .numerator = 1000,
     KEY(blur_milli),
     .help = "of the lens, standard deviation"},
    {.name = "backdrop_luma",
     .type = INI_WHOLE,
     .fallback = "80",
     .min = "0",
     .max = "255",
     KEY(backdrop_luma),
     .help = "mean brightness of what is behind the targets"},
    {.name = "backdrop_contrast",
     .type = INI_WHOLE,
     .fallback = "50",
     .min = "0",
     .max = "255",
     KEY(backdrop_contrast),
     .help = "and how rough it is"},
};

// ---------------------------------------------------------------- the scene

/// Right and up of a plate that faces the gimbal, upright.
static void face(const double ahead[3], double right[3], double up[3]) {
    const double level = hypot(ahead[0], ahead[1]);
    right[0] = level > 0.0 ? ahead[1] / level : 1.0;
    right[1] = level > 0.0 ? -ahead[0] / level : 0.0;
    right[2] = 0.0;
    up[0] = right[1] * ahead[2];
    up[1] = -right[0] * ahead[2];
    up[2] = right[0] * ahead[1] - right[1] * ahead[0];
}

static void scale(double v[3], double factor) {
    for (unsigned i = 0; i < 3U; i++) {
        v[i] *= factor;
    }
}

/// What a target looks like. texture: room for CELLS_MAX cells.
static void dress(const struct scenario_camera *camera, uint32_t id, struct render_object *object,
                  uint8_t *texture) {
    const double half_m = DISTANCE_M * tan((double)camera->keys.size_udeg * 0.5e-6 *
                                           (3.14159265358979323846 / 180.0));
    if (camera->keys.looks == LOOKS_LAMPS) {
        object->shape = RENDER_BALL;
        object->radius_m = half_m;
        object->luma = 245;
        return;
    }
    object->shape = RENDER_PLATE;
    object->texture = texture;
    scale(object->right_m, half_m);
    scale(object->up_m, half_m);
    if (camera->keys.looks == LOOKS_PEOPLE) {
        scale(object->up_m, 3.0);
        object->columns = 1;
        object->rows = 3;
        for (uint32_t i = 0; i < 3U; i++) { // clothes of its own
            texture[i] = (uint8_t)(15U + 60U * ((id * 7U + i * 5U) % 4U));
        }
        return;
    }
    uint32_t cells = 0;
    if (tags_draw(camera->rig->eye.detectors.tag_family, id, texture, &cells)) {
        object->columns = object->rows = cells;
        for (uint32_t i = 0; i < cells * cells; i++) {
            texture[i] = texture[i] == 0U ? 25U : 230U;
        }
    }
}

/// The targets as they really are at this moment.
static uint32_t place_targets(struct scenario_camera *camera, const struct sim *sim) {
    const struct target_set *truth = &sim->measure.truth;
    for (uint32_t i = 0; i < truth->count; i++) {
        struct render_object *object = &camera->objects[i];
        const struct vec3 d = truth->direction_q30[i];
        double ahead[3] = {ldexp(d.x, -30), ldexp(d.y, -30), ldexp(d.z, -30)};
        *object = (struct render_object){.luma = 0};
        face(ahead, object->right_m, object->up_m);
        scale(ahead, DISTANCE_M);
        memcpy(object->centre_m, ahead, sizeof ahead);
        dress(camera, truth->target[i].id, object, camera->texture + (size_t)i * CELLS_MAX);
    }
    return truth->count;
}

// ---------------------------------------------------------------- a frame

static bool ray(void *context, const double pixel[2], double direction[3]) {
    return camera_model_ray(context, pixel, direction);
}

/// The lens as the zoom really stands.
static bool focus(struct scenario_camera *camera, double zoom) {
    if (fabs(zoom - camera->rendered_zoom) <= 1e-4 * zoom) {
        return true;
    }
    const struct camera_model *base = &camera->rig->eye.model;
    struct camera_model model = camera_model_zoomed(base, zoom);
    const uint64_t random = camera->render.random;
    render_destroy(&camera->render);
    if (!render_create(&camera->render, base->width_px, base->height_px, ray, &model,
                       camera->seed)) {
        return false;
    }
    camera->render.random = random != 0U ? random : camera->render.random;
    camera->rendered_zoom = zoom;
    return true;
}

static void expose(struct scenario_camera *camera, struct sim *sim) {
    const struct scenario_camera_keys *keys = &camera->keys;
    const struct rig_eye *eye = &camera->rig->eye;
    const struct sim_view seen = sim_observe(sim);
    // The head's true axes take the place of a mount that does not turn.
    const struct mount head = {seen.right_q30, seen.ahead_q30, seen.up_q30};
    const struct camera_pose still = {0.0, 0.0, 1.0};
    const struct camera_view turned = camera_view_at(&head, &eye->seat, &still);
    struct render_view view = {.at_m = {0.0, 0.0, 0.0}};
    memcpy(view.right, turned.right, sizeof view.right);
    memcpy(view.ahead, turned.ahead, sizeof view.ahead);
    memcpy(view.up, turned.up, sizeof view.up);
    const struct render_backdrop backdrop = {(uint32_t)camera->seed, (double)keys->backdrop_luma,
                                             (double)keys->backdrop_contrast, 5.0};
    const struct render_sensor sensor = {(double)keys->blur_milli * 1e-3,
                                         (double)keys->noise_milli * 1e-3, 1.0};
    if (camera->waiting == SCENARIO_CAMERA_FRAMES ||
        !focus(camera, seen.focal_mm / eye->focal_mm)) {
        return; // a frame that nobody has room for is lost, as on a rig
    }
    struct scenario_frame *frame =
        &camera->frame[(camera->first + camera->waiting) % SCENARIO_CAMERA_FRAMES];
    const uint32_t count = place_targets(camera, sim);
    frame->at_us = sim->time_us;
    render_frame(&camera->render, &view, &backdrop, camera->objects, count, &sensor, frame->picture,
                 camera->render.width_px);
    camera->waiting++;
}

static void hear(void *context, const struct target_update *update) {
    struct scenario_camera *camera = context;
    (void)sim_hear(camera->sim, update); // a full queue is counted by the pump
}

/// The oldest frame goes to the detectors, whose answer comes at once: their time is in latency_ms.
static void deliver(struct scenario_camera *camera) {
    const struct scenario_frame *frame = &camera->frame[camera->first];
    const struct hal_camera_luma luma = {.luma = frame->picture,
                                         .width_px = camera->render.width_px,
                                         .height_px = camera->render.height_px,
                                         .stride_bytes = camera->render.width_px,
                                         .exposed_us = (uint32_t)frame->at_us};
    (void)!eye_look(camera->eye, &luma, hear, camera); // before the first pose nothing is told
    camera->first = (camera->first + 1U) % SCENARIO_CAMERA_FRAMES;
    camera->waiting--;
}

static void tell_pose(struct scenario_camera *camera, const struct sim *sim) {
    const struct camera_pose pose = gimbal_pose_tick(&camera->gimbal, &sim->pump.output.status);
    eye_pose(camera->eye, (uint32_t)sim->time_us, &pose);
}

static void step(void *context, struct sim *sim) {
    struct scenario_camera *camera = context;
    camera->sim = sim;
    if (sim->tick > 0U) {
        tell_pose(camera, sim);
    }
    if (sim->time_us >= camera->next_us) {
        expose(camera, sim);
        camera->next_us += (uint64_t)(1e9 / (double)camera->keys.fps_milli);
    }
    while (camera->waiting > 0U &&
           sim->time_us - camera->frame[camera->first].at_us >= (uint64_t)camera->keys.latency_us) {
        deliver(camera);
    }
}

// ---------------------------------------------------------------- opening

enum exit_status scenario_camera_open(struct scenario_camera *camera, const struct rig *rig,
                                      const struct ini *scenario, uint64_t seed) {
    static const enum detection_kind fits[] = {DETECTION_MARKER, DETECTION_TAG, DETECTION_MOVING};
    static const char *const words[] = {"markers", "tags", "motion"};
    camera->rig = rig;
    camera->seed = seed;
    camera->hook = (struct sim_camera){step, camera};
    if (!rig->eye.detectors.wanted[fits[camera->keys.looks]]) {
        ini_complain(scenario, "camera", "", "looks", "needs detect = %s in the rig's [camera]",
                     words[camera->keys.looks]);
        return EXIT_STATUS_USAGE;
    }
    struct eye_settings settings = {.model = rig->eye.model,
                                    .seat = rig->eye.seat,
                                    .latency_us = rig->eye.latency_us,
                                    .detectors = rig->eye.detectors};
    mount_init(&settings.mount, rig->controller.attitude);
    gimbal_pose_init(&camera->gimbal, &rig->controller, rig->fixed_focal_mm, rig->eye.focal_mm);
    camera->eye = eye_create(&settings);
    camera->objects = calloc(TARGET_CAPACITY, sizeof *camera->objects);
    camera->texture = calloc(TARGET_CAPACITY, CELLS_MAX);
    const size_t bytes = (size_t)rig->eye.model.width_px * rig->eye.model.height_px;
    bool room = camera->eye != NULL && camera->objects != NULL && camera->texture != NULL;
    for (unsigned i = 0; i < SCENARIO_CAMERA_FRAMES; i++) {
        camera->frame[i].picture = malloc(bytes);
        room = room && camera->frame[i].picture != NULL;
    }
    if (!room) {
        message_command("sim", "no memory for the camera");
        return EXIT_STATUS_FAILURE;
    }
    return EXIT_STATUS_OK;
}

void scenario_camera_close(struct scenario_camera *camera) {
    eye_destroy(camera->eye);
    render_destroy(&camera->render);
    free(camera->objects);
    free(camera->texture);
    for (unsigned i = 0; i < SCENARIO_CAMERA_FRAMES; i++) {
        free(camera->frame[i].picture);
    }
    memset(camera, 0, sizeof *camera);
}

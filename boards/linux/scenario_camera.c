#include "scenario_camera.h"

#include <stdlib.h>
#include <string.h>

/// In the order of enum stage_kind.
static const char *const looks[] = {"lamps", "tags", "people", NULL};

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

// ---------------------------------------------------------------- a frame

bool scenario_camera_draw(struct scenario_camera *camera, const struct sim *sim, uint8_t *picture) {
    const struct rig_eye *eye = &camera->rig->eye;
    const struct sim_view seen = sim_observe(sim);
    // The head's true axes take the place of a mount that does not turn.
    const struct mount head = {seen.right_q30, seen.ahead_q30, seen.up_q30};
    const struct camera_pose still = {0.0, 0.0, 1.0};
    const struct camera_view view = camera_view_at(&head, &eye->seat, &still);
    return stage_draw(&camera->stage, &view, seen.focal_mm / eye->focal_mm, &sim->measure.truth,
                      picture, eye->model.width_px);
}

uint64_t scenario_camera_period_us(const struct scenario_camera *camera) {
    return (uint64_t)(1e9 / (double)camera->keys.fps_milli);
}

static void expose(struct scenario_camera *camera, struct sim *sim) {
    struct scenario_frame *frame =
        &camera->frame[(camera->first + camera->waiting) % SCENARIO_CAMERA_FRAMES];
    if (camera->waiting == SCENARIO_CAMERA_FRAMES ||
        !scenario_camera_draw(camera, sim, frame->picture)) {
        return; // a frame that nobody has room for is lost, as on a rig
    }
    frame->at_us = sim->time_us;
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
                                         .width_px = camera->rig->eye.model.width_px,
                                         .height_px = camera->rig->eye.model.height_px,
                                         .stride_bytes = camera->rig->eye.model.width_px,
                                         .exposed_us = (uint32_t)frame->at_us};
    (void)!eye_look(camera->eye, &luma, (uint32_t)camera->sim->time_us, hear,
                    camera); // before the first pose nothing is told
    camera->first = (camera->first + 1U) % SCENARIO_CAMERA_FRAMES;
    camera->waiting--;
}

static void tell_pose(struct scenario_camera *camera, const struct sim *sim) {
    const struct camera_pose pose =
        gimbal_pose_tick(&camera->gimbal, &sim->pump.output.status, sim->time_us);
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
        camera->next_us += scenario_camera_period_us(camera);
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
    const struct scenario_camera_keys *keys = &camera->keys;
    const struct stage_looks dress = {
        .kind = (enum stage_kind)keys->looks,
        .size_deg = (double)keys->size_udeg * 1e-6,
        .sensor = {(double)keys->blur_milli * 1e-3, (double)keys->noise_milli * 1e-3, 1.0},
        .backdrop_luma = (double)keys->backdrop_luma,
        .backdrop_contrast = (double)keys->backdrop_contrast};
    const size_t bytes = (size_t)rig->eye.model.width_px * rig->eye.model.height_px;
    bool room = stage_open(&camera->stage, &rig->eye, &dress, seed) && camera->eye != NULL;
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
    stage_close(&camera->stage);
    for (unsigned i = 0; i < SCENARIO_CAMERA_FRAMES; i++) {
        free(camera->frame[i].picture);
    }
    memset(camera, 0, sizeof *camera);
}

/// `boresight detect`: what the detectors find in pictures, as a target stream.
#include "command.h"
#include "decimal.h"
#include "json.h"
#include "rig.h"

#include "detect/detector.h"
#include "detect/eye.h"
#include "detect/frame_file.h"
#include "detect/tags.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct settings {
    const char *find, *family, *rig, *fps;
    double pan_deg, tilt_deg;
    bool stats;
};

enum { FILES_MOST = 65536 };

/// The detectors of a stream of frames, and what was found.
struct watch {
    const struct settings *settings;
    struct detector_settings detectors;
    struct detector *detector;
    uint32_t width_px, height_px;
    double frame_us;
    bool has_rig;
    struct rig rig;
    struct camera_model model; ///< of these frames
    struct detector_sight sight;
    uint64_t frames, lines;
    double work_s;
    struct detections found;
};

static const char *option_degrees(const struct option *option, const char *text, void *place) {
    (void)option;
    struct decimal value;
    int64_t millionths = 0;
    if (decimal_read(text, strlen(text), &value) != DECIMAL_OK ||
        !decimal_scale(&value, 1000000, 1, &millionths) || llabs(millionths) > 3600000000) {
        return "is not an angle in degrees";
    }
    *(double *)place = (double)millionths * 1e-6;
    return NULL;
}

static const struct option options[] = {
    {"--find", "LIST", "tags, markers, motion, or several (default: the rig's, else all there are)",
     option_text, offsetof(struct settings, find), NULL},
    {"--family", "NAME", "of the tags: " TAGS_FAMILIES " (" TAGS_FAMILY_DEFAULT ")", option_text,
     offsetof(struct settings, family), NULL},
    {"--fps", "F", "frames a second, for the times (25)", option_text,
     offsetof(struct settings, fps), NULL},
    {"--rig", "RIG.ini", "the camera and where it stands: adds directions in the world",
     option_text, offsetof(struct settings, rig), NULL},
    {"--pan", "DEG", "with --rig: where the gimbal looked (0)", option_degrees,
     offsetof(struct settings, pan_deg), NULL},
    {"--tilt", "DEG", "likewise (0)", option_degrees, offsetof(struct settings, tilt_deg), NULL},
    {"--stats", NULL, "end with a line on stderr: frames, targets, time a frame", option_flag,
     offsetof(struct settings, stats), NULL},
};

// ---------------------------------------------------------------- results

__attribute__((format(printf, 2, 3))) static void number(struct json *json, const char *format,
                                                         ...) {
    char text[64];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    json_number(json, text);
}

static void numbers(struct json *json, const char *name, const double *values, unsigned count) {
    if (name != NULL) {
        json_key(json, name);
    }
    json_begin_array(json);
    for (unsigned i = 0; i < count; i++) {
        number(json, "%.3f", values[i]);
    }
    json_end_array(json);
}

static void print_direction(struct json *json, const struct target_update *update) {
    const int32_t component[3] = {update->direction.x, update->direction.y, update->direction.z};
    json_key(json, "dir");
    json_begin_array(json);
    for (unsigned i = 0; i < 3U; i++) {
        number(json, "%.9f", component[i] / 1073741824.0);
    }
    json_end_array(json);
    json_key(json, "radius");
    number(json, "%.5f", update->radius_bam32 * (360.0 / 4294967296.0));
}

static void begin_line(const struct watch *watch, struct json *json, uint32_t id) {
    json_start(json, stdout);
    json_begin_object(json);
    json_key(json, "t_us");
    json_u64(json, (uint64_t)((double)(watch->frames - 1U) * watch->frame_us + 0.5));
    json_key(json, "id");
    json_u64(json, id);
}

static void end_line(struct watch *watch, struct json *json) {
    json_end_object(json);
    putchar('\n');
    watch->lines++;
}

static void print_detection(struct watch *watch, const struct detection *detection) {
    struct json json;
    struct target_update update;
    const bool placed = watch->sight.model != NULL &&
                        eye_update_of(detection, watch->sight.model, &watch->sight.view, &update);
    begin_line(watch, &json, detection->id);
    json_key(&json, "object");
    json_text(&json, detection_kind_name(detection->kind));
    numbers(&json, "px", detection->pixel, 2);
    if (placed) {
        print_direction(&json, &update);
    } else {
        json_key(&json, "radius");
        number(&json, "%.3f", detection->radius_px);
    }
    json_key(&json, "confidence");
    number(&json, "%.3f", detection->confidence);
    numbers(&json, "box", detection->box_px, 4);
    if (detection->kind == DETECTION_TAG) {
        json_key(&json, "corners");
        json_begin_array(&json);
        for (unsigned i = 0; i < 4U; i++) {
            numbers(&json, NULL, detection->corner[i], 2);
        }
        json_end_array(&json);
    }
    end_line(watch, &json);
}

static void print_gone(struct watch *watch, uint32_t id) {
    struct json json;
    begin_line(watch, &json, id);
    json_key(&json, "gone");
    json_bool(&json, true);
    end_line(watch, &json);
}

// ---------------------------------------------------------------- frames

static double cpu_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

/// Detectors for frames of this size.
static bool begin_size(struct watch *watch, const struct hal_camera_luma *frame) {
    if (watch->detector != NULL && watch->width_px == frame->width_px &&
        watch->height_px == frame->height_px) {
        return true;
    }
    detector_destroy(watch->detector);
    watch->width_px = frame->width_px;
    watch->height_px = frame->height_px;
    watch->detector = detector_create(&watch->detectors, frame->width_px, frame->height_px);
    if (watch->has_rig) {
        const struct rig_eye *eye = &watch->rig.eye;
        struct mount mount;
        mount_init(&mount, watch->rig.controller.attitude);
        const struct camera_pose pose = {watch->settings->pan_deg, watch->settings->tilt_deg, 1.0};
        watch->model = camera_model_resized(&eye->model, frame->width_px, frame->height_px);
        watch->sight.model = &watch->model;
        watch->sight.view = camera_view_at(&mount, &eye->seat, &pose);
    }
    return watch->detector != NULL;
}

static enum exit_status take_frame(const struct command *command, struct watch *watch,
                                   const struct hal_camera_luma *frame) {
    if (frame->width_px < 16U || frame->height_px < 16U) {
        message_command(command->name, "pictures below 16 x 16 pixels show nothing");
        return EXIT_STATUS_USAGE;
    }
    if (!begin_size(watch, frame)) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    const double start_s = cpu_s();
    const uint32_t at_us = (uint32_t)(uint64_t)((double)watch->frames * watch->frame_us + 0.5);
    detector_frame(watch->detector, frame, at_us, &watch->sight, &watch->found);
    watch->work_s += cpu_s() - start_s;
    watch->frames++;
    for (uint32_t i = 0; i < watch->found.gone_count; i++) {
        print_gone(watch, watch->found.gone[i]);
    }
    for (uint32_t i = 0; i < watch->found.count; i++) {
        print_detection(watch, &watch->found.item[i]);
    }
    fflush(stdout); // the next command in the pipe wants it now
    return ferror(stdout) ? EXIT_STATUS_FAILURE : EXIT_STATUS_OK;
}

static enum exit_status take_file(const struct command *command, struct watch *watch,
                                  struct frame_file *file, const char *path) {
    if (!frame_file_open(file, path)) {
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    while (status == EXIT_STATUS_OK) {
        struct hal_camera_luma frame;
        const enum frame_file_status read = frame_file_next(file, &frame);
        if (read == FRAME_FILE_END) {
            break;
        }
        status = read == FRAME_FILE_OK ? take_frame(command, watch, &frame) : EXIT_STATUS_USAGE;
    }
    frame_file_close(file);
    return status;
}

// ---------------------------------------------------------------- the command

static bool choose_detectors(const struct command *command, const struct settings *settings,
                             struct watch *watch) {
    const char *all = tags_missing() == NULL ? "tags,markers,motion" : "markers,motion";
    if (watch->has_rig) {
        watch->detectors = watch->rig.eye.detectors;
    } else {
        watch->detectors.tag_family = TAGS_FAMILY_DEFAULT;
    }
    if (settings->family != NULL) {
        watch->detectors.tag_family = settings->family;
    }
    if (!tags_family_known(watch->detectors.tag_family)) {
        message_command(command->name, "--family %s: must be one of %s",
                        message_quoted(settings->family, strlen(settings->family)).text,
                        TAGS_FAMILIES);
        return false;
    }
    if (settings->find == NULL && watch->has_rig && watch->rig.eye.detects) {
        return true;
    }
    const char *find = settings->find != NULL ? settings->find : all;
    const char *wrong = detector_settings_read(&watch->detectors, find, (uint32_t)strlen(find));
    bool any = false;
    for (unsigned kind = 0; kind < DETECTION_KINDS; kind++) {
        any = any || watch->detectors.wanted[kind];
    }
    if (wrong != NULL || !any) {
        message_command(command->name, "--find: %s",
                        wrong != NULL ? wrong : "needs tags, markers or motion");
        return false;
    }
    return true;
}

static enum exit_status watch_files(const struct command *command, struct watch *watch,
                                    const char *const *files, size_t count) {
    struct frame_file file = {0};
    enum exit_status status = EXIT_STATUS_OK;
    for (size_t i = 0; status == EXIT_STATUS_OK && i < (count > 0U ? count : 1U); i++) {
        status = take_file(command, watch, &file, count > 0U ? files[i] : NULL);
    }
    frame_file_free(&file);
    if (status == EXIT_STATUS_OK && watch->settings->stats) {
        const double ms = watch->frames > 0U ? 1e3 * watch->work_s / (double)watch->frames : 0.0;
        message_command(command->name,
                        "%" PRIu64 " frames, %" PRIu64 " lines, %.2f ms of processor time a frame",
                        watch->frames, watch->lines, ms);
    }
    return status;
}

static enum exit_status detect(const struct command *command, const struct settings *settings,
                               const char *const *files, size_t count) {
    struct watch *watch = calloc(1, sizeof *watch);
    double fps = 25.0;
    if (watch == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    watch->settings = settings;
    enum exit_status status = EXIT_STATUS_OK;
    if (settings->rig != NULL) {
        status = rig_read(settings->rig, 0, &watch->rig);
        watch->has_rig = true;
    }
    if (status == EXIT_STATUS_OK &&
        ((settings->fps != NULL && !option_positive(command->name, "--fps", settings->fps, &fps)) ||
         !choose_detectors(command, settings, watch))) {
        status = EXIT_STATUS_USAGE;
    }
    watch->frame_us = 1e6 / fps;
    if (status == EXIT_STATUS_OK) {
        status = watch_files(command, watch, files, count);
    }
    detector_destroy(watch->detector);
    if (watch->has_rig) {
        rig_free(&watch->rig);
    }
    free(watch);
    return status;
}

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char **files = calloc(FILES_MOST, sizeof *files);
    size_t count = 0;
    enum exit_status status = EXIT_STATUS_USAGE;
    if (files == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    if (options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                     files, FILES_MOST, &count)) {
        if (settings.rig == NULL && (settings.pan_deg != 0.0 || settings.tilt_deg != 0.0)) {
            message_command(command->name, "--pan and --tilt belong to --rig");
        } else {
            status = detect(command, &settings, files, count);
        }
    }
    free(files);
    return status;
}

const struct command command_detect = {
    .name = "detect",
    .summary = "find tags, bright markers and moving objects in pictures",
    .operands = "[FRAME...]",
    .help =
        "Reads pictures (PGM, PPM, JPEG; no file or -: stdin, where PGM and PPM pictures may "
        "follow\n"
        "each other) as the frames of one camera and prints what is in them: a target stream, a\n"
        "JSON object a line, for 'boresight run --targets -'. A film:\n"
        "  ffmpeg -v error -i FILM -f image2pipe -c:v pgm - | boresight detect --find motion\n\n"
        "tags: AprilTags; their number is the id. markers: round bright spots; ids from 1000000.\n"
        "motion: what moves before a background that is learned from the first half second on;\n"
        "ids from 2000000. A target that was followed and is no more gets \"gone\": true.\n\n"
        "results, a line for each target in each frame:\n"
        "  px, radius      its middle and the circle that holds it, in pixels; (0, 0) is the "
        "middle\n"
        "                  of the top left pixel\n"
        "  dir, radius     with --rig: direction in the world, and the radius in degrees\n"
        "  confidence      0 to 1\n"
        "  box             left, top, right, bottom in pixels\n"
        "  corners         of a tag, counterclockwise\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};

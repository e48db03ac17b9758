/// `boresight calibrate`: measures a rig and writes what it found into its file.
#include "calibrate.h"
#include "command.h"
#include "degrees.h"
#include "facts.h"
#include "ini_edit.h"
#include "lines.h"
#include "pointing.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHANGES_MAX = 16 };
#define LENS_TOLD 0.02 ///< so much longer or shorter than in the file

struct settings {
    const char *sightings;
    bool keep_limits, camera, lens, dry_run, json;
};

static const struct option options[] = {
    {"--sightings", "FILE", "fit the pointing model to sightings; nothing moves", option_text,
     offsetof(struct settings, sightings), NULL},
    {"--keep-limits", NULL, "don't look for the ends of the axes", option_flag,
     offsetof(struct settings, keep_limits), NULL},
    {"--camera", NULL, "measure nothing but the camera's latency and focal length", option_flag,
     offsetof(struct settings, camera), NULL},
    {"--lens", NULL, "write that focal length, too", option_flag, offsetof(struct settings, lens),
     NULL},
    {"--dry-run", NULL, "print what was found, and leave the rig file as it is", option_flag,
     offsetof(struct settings, dry_run), NULL},
    OPTION_JSON(struct settings),
};

struct changes {
    struct ini_change item[CHANGES_MAX];
    unsigned count;
};

static const char *const names[] = {"pan", "tilt"};

static char *change(struct changes *changes, const char *section, const char *key) {
    struct ini_change *item = &changes->item[changes->count++];
    *item = (struct ini_change){.section = section, .key = key};
    return item->value;
}

static void change_number(struct changes *changes, const char *section, const char *key,
                          double value, int places) {
    snprintf(change(changes, section, key), INI_CHANGE_BYTES, "%.*f", places, value);
}

static void change_list(struct changes *changes, const char *section, const char *key,
                        const double *values, uint32_t count, int places) {
    char *text = change(changes, section, key);
    size_t at = 0;
    for (uint32_t i = 0; i < count; i++) {
        at += (size_t)snprintf(text + at, INI_CHANGE_BYTES - at, "%s%.*f", i == 0U ? "" : ", ",
                               places, values[i]);
    }
}

/// When, and what, behind the change that was made last.
static void note(struct changes *changes, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void note(struct changes *changes, const char *format, ...) {
    char *const text = changes->item[changes->count - 1U].note;
    const time_t now = time(NULL);
    struct tm utc;
    const size_t at = strftime(text, INI_NOTE_BYTES, "%Y-%m-%d %H:%M UTC: ", gmtime_r(&now, &utc));
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + at, INI_NOTE_BYTES - at, format, arguments);
    va_end(arguments);
}

static enum exit_status write_back(const struct ini *ini, const struct settings *settings,
                                   const struct changes *changes) {
    return settings->dry_run ? EXIT_STATUS_OK : ini_edit_file(ini, changes->item, changes->count);
}

// ---------------------------------------------------------------- motion

static const char *fact_name(const char *axis, const char *what) {
    static char name[40];
    snprintf(name, sizeof name, "%s_%s", axis, what);
    return name;
}

static void print_axis(struct facts *facts, const char *name, const struct calibrate_axis *axis) {
    static const char *const ends[] = {"limit", "switch", "stop"};
    if (!axis->measured) {
        facts_null(facts, fact_name(name, "latency_ms"), "it does not measure its position");
        return;
    }
    facts_text(facts, fact_name(name, "low_end"), ends[axis->end[0]]);
    facts_fixed(facts, fact_name(name, "min_deg"), axis->end_deg[0], 2);
    facts_text(facts, fact_name(name, "high_end"), ends[axis->end[1]]);
    facts_fixed(facts, fact_name(name, "max_deg"), axis->end_deg[1], 2);
    facts_reals(facts, fact_name(name, "move_deg"), axis->move_deg, axis->move_count);
    facts_reals(facts, fact_name(name, "move_s"), axis->move_s, axis->move_count);
    facts_reals(facts, fact_name(name, "move_spread_s"), axis->move_spread_s, axis->move_count);
    if (axis->speed_dps > 0.0) {
        facts_fixed(facts, fact_name(name, "speed_dps"), axis->speed_dps, 2);
    } else {
        facts_null(facts, fact_name(name, "speed_dps"), "too many ticks were missed");
    }
    facts_fixed(facts, fact_name(name, "latency_ms"), axis->latency_ms, 2);
    facts_fixed(facts, fact_name(name, "latency_spread_ms"), axis->latency_spread_ms, 2);
    facts_u64(facts, fact_name(name, "rounds"), axis->rounds);
}

/// What the person should know of rounds that never agreed.
static void tell_noise(const struct command *command, const char *name,
                       const struct calibrate_axis *axis) {
    if (!axis->noisy) {
        return;
    }
    for (uint32_t i = 0; i < axis->move_count; i++) {
        message_command(command->name, "noisy: %s: %.0f degrees took %.3f s, spread %.3f s", name,
                        axis->move_deg[i], axis->move_s[i], axis->move_spread_s[i]);
    }
    message_command(command->name,
                    "noisy: %s: latency %.1f ms, spread %.1f ms, after %u rounds; is the machine "
                    "busy, or the drive loose?",
                    name, axis->latency_ms, axis->latency_spread_ms, axis->rounds);
}

static void change_axis(struct changes *changes, const char *name,
                        const struct calibrate_axis *axis) {
    static const char *const keys[] = {"limit_min_deg", "limit_max_deg"};
    for (unsigned side = 0; side < 2U; side++) {
        if (axis->end[side] != CALIBRATE_END_LIMIT) { // only ever narrower than it was
            const double inward =
                side == 0U ? ceil(axis->end_deg[side] * 100.0) : floor(axis->end_deg[side] * 100.0);
            change_number(changes, name, keys[side], inward / 100.0, 2);
            note(changes, "2 degrees before %s",
                 axis->end[side] == CALIBRATE_END_SWITCH ? "the switch" : "what is in the way");
        }
    }
    if (axis->move_count > 0U) {
        double spread_s = 0.0;
        for (uint32_t i = 0; i < axis->move_count; i++) {
            spread_s = fmax(spread_s, axis->move_spread_s[i]);
        }
        change_list(changes, name, "move_deg", axis->move_deg, axis->move_count, 0);
        change_list(changes, name, "move_s", axis->move_s, axis->move_count, 3);
        note(changes, "%smedian of %u rounds, spread %.3f s", axis->noisy ? "noisy, " : "",
             axis->rounds, spread_s);
    }
    change_number(changes, name, "latency_ms", axis->latency_ms, 1);
    note(changes, "%smedian of %u rounds, spread %.1f ms", axis->noisy ? "noisy, " : "",
         axis->rounds, axis->latency_spread_ms);
}

static void print_camera(struct facts *facts, const struct calibrate_camera *camera) {
    if (camera->measured) {
        facts_fixed(facts, "camera_latency_ms", camera->latency_ms, 2);
        facts_fixed(facts, "camera_fx_px", camera->fx_px, 2);
        facts_fixed(facts, "camera_rms_deg", camera->rms_deg, 4);
        facts_u64(facts, "camera_sights", camera->sights);
    } else if (camera->why_not != NULL) {
        facts_null(facts, "camera_latency_ms", camera->why_not);
    }
}

/// A good chessboard knows better than a gimbal whose camera sits before its axes, so the lens is
/// only written where that is asked for.
static void change_camera(struct changes *changes, const struct calibrate_camera *camera,
                          const struct settings *settings, const char *command) {
    change_number(changes, "camera", "latency_ms", camera->latency_ms, 1);
    note(changes, "%u sightings, %.3f degrees rms apart", camera->sights, camera->rms_deg);
    const double lens = camera->fx_px / camera->given_fx_px;
    if (settings->lens) {
        change_number(changes, "camera", "fx_px", camera->fx_px, 1);
        note(changes, "%u sightings, %.3f degrees rms apart", camera->sights, camera->rms_deg);
        if (camera->given_fy_px != camera->given_fx_px) {
            change_number(changes, "camera", "fy_px", lens * camera->given_fy_px, 1);
        }
    } else if (fabs(lens - 1.0) > LENS_TOLD) {
        message_command(
            command,
            "by how far things move in the picture the lens has fx_px = %.1f, not %.1f; "
            "--lens writes it",
            camera->fx_px, camera->given_fx_px);
    }
}

static enum exit_status calibrate_motion(const struct command *command,
                                         const struct settings *settings, const char *file) {
    struct calibrate *calibrate = calloc(1, sizeof *calibrate);
    if (calibrate == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    const struct calibrate_settings measuring = {.command = command->name,
                                                 .rig_file = file,
                                                 .with_ends = !settings->keep_limits,
                                                 .only_camera = settings->camera};
    enum exit_status status = calibrate_run(calibrate, &measuring);
    if (status == EXIT_STATUS_OK) {
        struct facts facts;
        struct changes changes = {.count = 0};
        facts_begin(&facts, stdout, settings->json);
        for (unsigned axis = 0; axis < 2U && !settings->camera; axis++) {
            print_axis(&facts, names[axis], &calibrate->axis[axis]);
            if (calibrate->axis[axis].measured) {
                change_axis(&changes, names[axis], &calibrate->axis[axis]);
                tell_noise(command, names[axis], &calibrate->axis[axis]);
            }
        }
        print_camera(&facts, &calibrate->camera);
        if (calibrate->camera.measured) {
            change_camera(&changes, &calibrate->camera, settings, command->name);
        } else if (calibrate->camera.why_not != NULL) {
            message_command(command->name, "no latency of the camera: %s",
                            calibrate->camera.why_not);
        }
        status = write_back(&calibrate->runner.rig.ini, settings, &changes);
        facts_bool(&facts, "written", status == EXIT_STATUS_OK && !settings->dry_run);
        facts_end(&facts);
    }
    calibrate_close(calibrate);
    free(calibrate);
    return status;
}

// ---------------------------------------------------------------- sightings

/// PAN TILT X Y Z. False: the line is not that.
static bool read_sighting(const char *text, size_t size, const struct rig *rig,
                          struct pointing_sighting *sighting) {
    char line[512];
    double value[5];
    if (size >= sizeof line) {
        return false;
    }
    memcpy(line, text, size);
    line[size] = '\0';
    char *at = line;
    for (unsigned i = 0; i < 5U; i++) {
        char *end;
        at += strspn(at, " \t,");
        value[i] = strtod(at, &end);
        if (end == at || !isfinite(value[i])) {
            return false;
        }
        at = end;
    }
    at += strspn(at, " \t,");
    if (*at != '\0' && *at != '#') {
        return false;
    }
    const struct vec3_i64 from = rig->controller.position_um;
    const double away[3] = {value[2] - (double)from.x * 1e-6, value[3] - (double)from.y * 1e-6,
                            value[4] - (double)from.z * 1e-6};
    const double length = sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]);
    if (!(length > 0.0)) {
        return false;
    }
    *sighting = (struct pointing_sighting){
        value[0], value[1], {away[0] / length, away[1] / length, away[2] / length}};
    return true;
}

static enum exit_status read_sightings(const char *path, const struct rig *rig,
                                       struct pointing_sighting *sightings, size_t *count) {
    static struct lines lines;
    const char *text;
    size_t size;
    enum lines_status status;
    bool good = lines_open(&lines, path);
    if (!good) {
        return EXIT_STATUS_USAGE;
    }
    *count = 0;
    while ((status = lines_next(&lines, &text, &size)) == LINES_OK) {
        size_t first = 0;
        while (first < size && (text[first] == ' ' || text[first] == '\t')) {
            first++;
        }
        if (first == size || text[first] == '#') {
            continue;
        }
        if (*count == POINTING_SIGHTINGS_MAX) {
            message_at(lines.name, lines.number, "more than %d sightings", POINTING_SIGHTINGS_MAX);
            good = false;
        } else if (!read_sighting(text, size, rig, &sightings[*count])) {
            message_at(lines.name, lines.number,
                       "is no sighting; give PAN_DEG TILT_DEG and the X Y Z of what was seen");
            good = false;
        } else {
            (*count)++;
        }
    }
    lines_close(&lines);
    return good && status == LINES_END ? EXIT_STATUS_OK : EXIT_STATUS_USAGE;
}

static double degrees_bam(bam32_t angle) {
    return (double)(int32_t)angle.bam * (360.0 / 4294967296.0);
}

/// The zero of tilt is the drive's business: what it reads at angle 0, or which pulse belongs to
/// which angle.
static void change_tilt(struct changes *changes, const struct rig *rig, double offset_deg) {
    const struct drive_config *drive = &rig->controller.axis[AXIS_TILT].drive;
    if (drive->kind == DRIVE_PWM) {
        const double angles[2] = {degrees(drive->pwm.low_q48) + offset_deg,
                                  degrees(drive->pwm.high_q48) + offset_deg};
        change_list(changes, "tilt", "calibration_deg", angles, 2, 4);
    } else {
        const double zero = degrees(drive->rmd.zero_q48);
        change_number(changes, "tilt", "zero_deg",
                      drive->rmd.reversed ? zero + offset_deg : zero - offset_deg, 4);
    }
}

static enum exit_status calibrate_pointing(const struct settings *settings, const char *file) {
    static struct pointing_sighting sightings[POINTING_SIGHTINGS_MAX];
    struct rig rig;
    size_t count = 0;
    enum exit_status status = rig_read(file, 0, &rig);
    if (status == EXIT_STATUS_OK) {
        status = read_sightings(settings->sightings, &rig, sightings, &count);
    }
    if (status != EXIT_STATUS_OK) {
        rig_free(&rig);
        return status;
    }
    const struct mount_attitude *attitude = &rig.controller.attitude;
    struct pointing_model model = {degrees_bam(attitude->heading), degrees_bam(attitude->pitch),
                                   degrees_bam(attitude->roll), 0.0};
    double rms_deg = 0.0;
    const bool with_offset = count >= 3U;
    if (!pointing_fit(sightings, count, with_offset, &model, &rms_deg)) {
        message_at(settings->sightings, 0,
                   "these sightings do not determine the model: give more, far apart in pan and "
                   "tilt");
        rig_free(&rig);
        return EXIT_STATUS_INFEASIBLE;
    }
    struct changes changes = {.count = 0};
    change_number(&changes, "mount", "heading_deg", model.heading_deg, 4);
    change_number(&changes, "mount", "pitch_deg", model.pitch_deg, 4);
    change_number(&changes, "mount", "roll_deg", model.roll_deg, 4);
    if (with_offset) {
        change_tilt(&changes, &rig, model.tilt_offset_deg);
    }
    status = write_back(&rig.ini, settings, &changes);
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_u64(&facts, "sightings", count);
    facts_fixed(&facts, "heading_deg", model.heading_deg, 4);
    facts_fixed(&facts, "pitch_deg", model.pitch_deg, 4);
    facts_fixed(&facts, "roll_deg", model.roll_deg, 4);
    facts_fixed(&facts, "tilt_offset_deg", model.tilt_offset_deg, 4);
    facts_fixed(&facts, "rms_deg", rms_deg, 5);
    facts_bool(&facts, "written", status == EXIT_STATUS_OK && !settings->dry_run);
    facts_end(&facts);
    rig_free(&rig);
    return status;
}

// ---------------------------------------------------------------- the command

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *file = NULL;
    if (!options_read_file(command->name, command->options, command->option_count, argc, argv,
                           &settings, "rig", &file)) {
        return EXIT_STATUS_USAGE;
    }
    if (!settings.dry_run && !ini_edit_allowed(file)) { // before anything moves
        return EXIT_STATUS_FAILURE;
    }
    return settings.sightings != NULL ? calibrate_pointing(&settings, file)
                                      : calibrate_motion(command, &settings, file);
}

const struct command command_calibrate = {
    .name = "calibrate",
    .summary = "measure a rig and write what was found into its file",
    .operands = "RIG.ini",
    .help =
        "Moves pan and tilt, slowly toward each limit of the rig file, then in moves of 10, 30 "
        "and\n"
        "90 degrees as far as they fit, and writes into the file: limits, where a switch or\n"
        "something in the way comes first (2 degrees before it; never wider than they were);\n"
        "move_deg and move_s, how long moves take; latency_ms, how long an axis is behind its\n"
        "setpoint. Moves are repeated until they agree; behind each value stands when and how\n"
        "it was measured (# measured ...). Hobby servos tell nobody where they are and are not\n"
        "measured. The emergency stop and SIGINT end it, and nothing is written.\n\n"
        "With device = ... in [camera]: pan swings by up to 8 degrees to either side while the\n"
        "camera looks at something that stands still (a tag, a lamp), and latency_ms of [camera]\n"
        "becomes what lets it stand still; of hobby servos with what they are late by. How far it\n"
        "moves in the picture tells the focal length, camera_fx_px; --lens writes that.\n\n"
        "With --sightings nothing moves: each line of FILE is `PAN_DEG TILT_DEG X Y Z`, what the\n"
        "axes read (`boresight run` prints it) while the camera looked exactly at the point X Y "
        "Z.\n"
        "Two sightings give heading, pitch and roll of [mount], three or more also the zero of\n"
        "tilt.\n\n"
        "Only values change; comments and everything else in the file stay. A file that was\n"
        "changed meanwhile is left alone.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};

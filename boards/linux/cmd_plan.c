/// `boresight plan`: where to mount the camera.
#include "command.h"
#include "plan_report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct settings {
    const char *mounts, *rig, *scene, *size, *distance, *above, *unit_cm, *picture;
    uint64_t count;
    int rank; ///< enum rank
    bool named, lines, json;
};

enum rank { RANK_PX, RANK_CM };
static const char *const ranks[] = {"px", "cm", NULL};

static const struct option options[] = {
    {"--mounts", "FILE", "where it may be mounted, one place a line; without it some are proposed",
     option_text, offsetof(struct settings, mounts), NULL},
    {"--named", NULL, "a name stands before the numbers of each line, in both files", option_flag,
     offsetof(struct settings, named), NULL},
    {"--rig", "RIG.ini", "its limits, lens and sensor (none: any direction, any zoom)", option_text,
     offsetof(struct settings, rig), NULL},
    {"--scene", "FILE.scene", "what may be in the way: solids and faces", option_text,
     offsetof(struct settings, scene), NULL},
    {"--size", "WxH", "of the picture in pixels (1280x720)", option_text,
     offsetof(struct settings, size), NULL},
    {"--rank", "px|cm", "by the margin in the picture, or of the mount's place (px)", option_choice,
     offsetof(struct settings, rank), ranks},
    {"--lines", NULL, "only that targets hide each other counts, not that three line up",
     option_flag, offsetof(struct settings, lines), NULL},
    {"--count", "N", "how many mounts to propose (5)", option_u64, offsetof(struct settings, count),
     NULL},
    {"--distance", "D", "of proposals from the targets (so that they fill the picture)",
     option_text, offsetof(struct settings, distance), NULL},
    {"--above", "Z", "no proposal is lower (the lowest target)", option_text,
     offsetof(struct settings, above), NULL},
    {"--unit-cm", "CM", "centimetres in a unit of the files (100)", option_text,
     offsetof(struct settings, unit_cm), NULL},
    {"--picture", "FILE.svg", "draw the sphere of directions about the targets for the best mount",
     option_text, offsetof(struct settings, picture), NULL},
    OPTION_JSON(struct settings),
};

// ---------------------------------------------------------------- what is planned

struct work {
    const struct settings *settings;
    struct rig rig;
    struct scene_text scene;
    struct plan plan;
    struct plan_region region;
    char *words; ///< of proposals
    struct plan_ranking ranking;
};

static const char *name_of_file(const char *file) {
    return file == NULL || strcmp(file, "-") == 0 ? "stdin" : file;
}

static bool read_number(const char *name, const char *text, double *out) {
    struct decimal value;
    int64_t millionths;
    if (decimal_read(text, strlen(text), &value) != DECIMAL_OK ||
        !decimal_scale(&value, 1000000, 1, &millionths)) {
        message_command("plan", "%s %s: must be a number", name,
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    *out = (double)millionths * 1e-6;
    return true;
}

static bool read_size(const char *text, struct plan_camera *camera) {
    char rest;
    unsigned width, height;
    if (strspn(text, "0123456789x") != strlen(text) ||
        sscanf(text, "%5ux%5u%c", &width, &height, &rest) != 2 || width < 16U || height < 16U ||
        width > 32768U || height > 32768U) {
        message_command("plan", "--size %s: must be WxH, each from 16 to 32768",
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    camera->width_px = width;
    camera->height_px = height;
    return true;
}

static bool read_settings(struct work *work) {
    const struct settings *const s = work->settings;
    work->plan.planes = !s->lines;
    work->plan.unit_cm = 100;
    work->plan.camera = (struct plan_camera){.width_px = 1280, .height_px = 720};
    if (s->mounts != NULL && (s->distance != NULL || s->above != NULL || s->count != 0U)) {
        message_command("plan", "--mounts goes without --count, --distance and --above");
        return false;
    }
    if (s->count > 100U) {
        message_command("plan", "--count: at most 100");
        return false;
    }
    work->ranking.proposed = s->mounts == NULL;
    work->region.count = s->count == 0U ? 5U : (uint32_t)s->count;
    return (s->size == NULL || read_size(s->size, &work->plan.camera)) &&
           (s->unit_cm == NULL ||
            option_positive("plan", "--unit-cm", s->unit_cm, &work->plan.unit_cm)) &&
           (s->distance == NULL ||
            option_positive("plan", "--distance", s->distance, &work->region.distance)) &&
           (s->above == NULL || read_number("--above", s->above, &work->region.above));
}

static enum exit_status read_rig(struct work *work) {
    if (work->settings->rig == NULL) {
        return EXIT_STATUS_OK;
    }
    const enum exit_status status = rig_read(work->settings->rig, 0, &work->rig);

    if (status == EXIT_STATUS_OK) {
        work->plan.camera.rig = &work->rig;
        mount_init(&work->plan.camera.mount, work->rig.controller.attitude);
    }
    return status;
}

static enum exit_status read_scene(struct work *work) {
    const char *const file = work->settings->scene;
    if (file == NULL) {
        return EXIT_STATUS_OK;
    }
    work->plan.text = &work->scene;
    work->plan.text_file = name_of_file(file);
    return scene_text_read(file, true, &work->scene);
}

static enum exit_status read_places(const struct work *work, const char *file, struct points *out) {
    const struct points_format format = {
        .input = POINTS_XYZ, .named = work->settings->named, .places = true};
    return points_read(file, &format, out);
}

static enum exit_status read_targets(struct work *work, const char *file) {
    const enum exit_status status = read_places(work, file, &work->ranking.targets);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (work->ranking.targets.count == 0U) {
        message_at(name_of_file(file), 0, "no points");
        return EXIT_STATUS_USAGE;
    }
    if (work->ranking.targets.count > PLAN_TARGETS_MAX) {
        message_at(name_of_file(file), 0, "%lu targets; at most %d",
                   (unsigned long)work->ranking.targets.count, PLAN_TARGETS_MAX);
        return EXIT_STATUS_USAGE;
    }
    if (work->ranking.targets.count > PLAN_TARGETS_PLANES_MAX) {
        work->plan.planes = false;
    }
    return EXIT_STATUS_OK;
}

static enum exit_status read_mounts(struct work *work) {
    const char *const file = work->settings->mounts;
    const enum exit_status status = read_places(work, file, &work->ranking.mounts);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (work->ranking.mounts.count == 0U || work->ranking.mounts.count > PLAN_MOUNTS_MAX) {
        message_at(name_of_file(file), 0,
                   work->ranking.mounts.count == 0U ? "no mounts" : "more than %d mounts",
                   PLAN_MOUNTS_MAX);
        return EXIT_STATUS_USAGE;
    }
    return plan_set(&work->plan, &work->ranking.targets, work->ranking.mounts.place_text,
                    work->ranking.mounts.count, 0);
}

/// Two targets at one place are one: told by their lines.
static enum exit_status check_targets(const struct work *work, const char *file) {
    for (uint32_t i = 0; i < work->plan.target_count; i++) {
        for (uint32_t j = 0; j < i; j++) {
            if (vec3_equal(work->plan.targets[i], work->plan.targets[j])) {
                message_at(name_of_file(file), work->ranking.targets.lines[i],
                           "the same place as in line %lu%s",
                           (unsigned long)work->ranking.targets.lines[j],
                           work->plan.exact ? "" : ", to the resolution of the grid");
                return EXIT_STATUS_USAGE;
            }
        }
    }
    return EXIT_STATUS_OK;
}

static enum exit_status propose(struct work *work, const char *file) {
    struct plan *const plan = &work->plan;
    enum exit_status status = plan_set(plan, &work->ranking.targets, NULL, 0, 0);
    if (status == EXIT_STATUS_OK) {
        status = check_targets(work, file);
    }
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (work->settings->distance == NULL) {
        work->region.distance = plan_distance(plan);
    }
    if (work->settings->above == NULL) {
        work->region.above = INFINITY;
        for (uint32_t i = 0; i < plan->target_count; i++) {
            work->region.above = fmin(work->region.above, plan->targets[i].z * plan->grid);
        }
    }
    const uint32_t count = plan_propose(&work->ranking.targets, plan, &work->region, &work->words);
    if (count == UINT32_MAX) {
        message_command("plan", "no memory for proposals");
        return EXIT_STATUS_FAILURE;
    }
    plan_free(plan);
    return plan_set(plan, &work->ranking.targets, work->words, count, 0);
}

// ---------------------------------------------------------------- the ranking

/// Pixels as printed, so that views that are alike don't differ by roundings.
static double printed_px(const struct plan_view *view) {
    return isfinite(view->margin_px) ? round(view->margin_px * 1000) : INFINITY;
}

static bool is_better(const struct plan_view *a, const struct plan_view *b, enum rank rank) {
    const double px_a = printed_px(a), px_b = printed_px(b);
    if (a->usable != b->usable) {
        return a->usable;
    }
    if (rank == RANK_PX && px_a != px_b) {
        return px_a > px_b;
    }
    return a->margin_cm != b->margin_cm ? a->margin_cm > b->margin_cm : px_a > px_b;
}

static enum exit_status look_from_all(struct work *work) {
    const uint32_t count = work->ranking.count = work->plan.mount_count;
    work->ranking.views = malloc(((size_t)count + 1U) * sizeof *work->ranking.views);
    work->ranking.order = malloc(((size_t)count + 1U) * sizeof *work->ranking.order);
    if (work->ranking.views == NULL || work->ranking.order == NULL) {
        message_command("plan", "no memory for %lu mounts", (unsigned long)count);
        return EXIT_STATUS_FAILURE;
    }
    for (uint32_t i = 0; i < count; i++) {
        const enum exit_status status =
            plan_look(&work->plan, work->plan.mounts[i], &work->ranking.views[i]);
        if (status != EXIT_STATUS_OK) {
            return status;
        }
        uint32_t at = i;
        for (; at > 0U && is_better(&work->ranking.views[i],
                                    &work->ranking.views[work->ranking.order[at - 1U]],
                                    (enum rank)work->settings->rank);
             at--) {
            work->ranking.order[at] = work->ranking.order[at - 1U];
        }
        work->ranking.order[at] = i;
    }
    return EXIT_STATUS_OK;
}

// ---------------------------------------------------------------- the whole

static enum exit_status draw(const struct work *work, const struct plan_sphere *sphere) {
    const uint32_t best = work->ranking.order[0];
    const double *const p = work->ranking.views[best].place;
    const char *const name = points_name(&work->ranking.mounts, best);
    char title[200];
    if (!(sphere->radius > 0)) {
        message_command("plan", "no picture: the mount is in the centre of the targets");
        return EXIT_STATUS_USAGE;
    }
    snprintf(title, sizeof title, "%s %.60s%sat %.6g %.6g %.6g",
             work->settings->mounts == NULL ? "proposed," : "mount", name == NULL ? "" : name,
             name == NULL ? "" : " ", p[0], p[1], p[2]);
    return plan_draw(&work->plan, sphere, title, work->settings->picture);
}

static enum exit_status finish(struct work *work) {
    struct plan_sphere sphere = {0};
    enum exit_status status = EXIT_STATUS_OK;
    if (work->ranking.count != 0U &&
        !plan_sphere_set(&sphere, &work->plan, &work->ranking.views[work->ranking.order[0]])) {
        message_command("plan", "no memory for the sphere of %lu targets",
                        (unsigned long)work->plan.target_count);
        status = EXIT_STATUS_FAILURE;
    }
    if (status == EXIT_STATUS_OK && work->settings->picture != NULL && work->ranking.count != 0U) {
        status = draw(work, &sphere);
    }
    if (status == EXIT_STATUS_OK) {
        plan_report(&work->ranking, &work->plan, &sphere, work->settings->json);
        const bool any =
            work->ranking.count != 0U && work->ranking.views[work->ranking.order[0]].usable;
        status = any ? EXIT_STATUS_OK : EXIT_STATUS_INFEASIBLE;
    }
    plan_sphere_free(&sphere);
    return status;
}

static enum exit_status run_work(struct work *work, const char *file) {
    enum exit_status status = read_rig(work);
    if (status == EXIT_STATUS_OK) {
        status = read_scene(work);
    }
    if (status == EXIT_STATUS_OK) {
        status = read_targets(work, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = work->settings->mounts != NULL ? read_mounts(work) : propose(work, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = check_targets(work, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = look_from_all(work);
    }
    return status == EXIT_STATUS_OK ? finish(work) : status;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *file = NULL;
    size_t operands;
    struct work work = {.settings = &settings};
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      &file, 1, &operands) ||
        !read_settings(&work)) {
        return EXIT_STATUS_USAGE;
    }
    const enum exit_status status = run_work(&work, file);
    rig_free(&work.rig);
    scene_text_free(&work.scene);
    free(work.ranking.views);
    free(work.ranking.order);
    free(work.words);
    plan_free(&work.plan);
    points_free(&work.ranking.targets);
    points_free(&work.ranking.mounts);
    return status;
}

const struct command command_plan = {
    .name = "plan",
    .summary = "where to mount the camera, so that targets don't line up",
    .operands = "[POINTS]",
    .help =
        "Ranks places for a camera that shall see a set of targets, or proposes some. From a "
        "place\n"
        "on the line through two targets these coincide in the picture, and from one in the plane\n"
        "through three these line up. How far a place is from the nearest such line and plane is\n"
        "decided exactly; that margin is how far the mount may be off.\n\n"
        "POINTS and the file of --mounts hold one place a line, x y z in metres (--unit-cm);\n"
        "without POINTS, or with -, stdin is read. Where all coordinates are whole multiples of\n"
        "one power of ten, and at most 8388607 of them, every decision is exact for the numbers "
        "as\n"
        "written (`exact yes`); else they are rounded to 23 bits of the largest. At most 2000\n"
        "targets; beyond 200 the nearest plane is not looked for (as with --lines).\n\n"
        "results:\n"
        "  collinear_triples collinear\n"
        "                   triples of targets on one line, which line up from everywhere and\n"
        "                   don't count; the first of them\n"
        "  tolerance_deg    how far the best mount may move on the sphere about the targets\n"
        "of each mount, the best first:\n"
        "  usable why_not   whether the rig can see all targets at once from there\n"
        "  feasible         whether some direction has every target in front of it; else "
        "`witness`\n"
        "  pan_deg tilt_deg half_angle_deg\n"
        "                   the narrowest cone that holds all targets\n"
        "  reachable        whether the rig's limits let it look there\n"
        "  zoom focal_mm    the lens: `fits`, `no margin`, `too wide`, or `small`: at its long "
        "end\n"
        "                   the targets don't fill the picture\n"
        "  hidden hidden_by targets that the scene hides, and the name of an object that does\n"
        "  lines_through planes_through\n"
        "                   pairs and triples of targets with the mount on their line or plane\n"
        "  lined_up lined_up_first lined_up_normal\n"
        "                   triples of targets on one line in the picture, the first of them, and\n"
        "                   the direction in which the mount leaves their plane\n"
        "  line line_at line_cm, plane plane_at plane_cm\n"
        "                   the nearest ones, the nearest place on them, and how far that is,\n"
        "                   rounded down\n"
        "  margin_cm        the less of both: moved by less, no two targets coincide and no three\n"
        "                   line up\n"
        "  pair pair_px     the two targets that are closest together in the picture\n"
        "  triple triple_px the flattest triangle of targets in the picture, by its least height\n"
        "  margin_px        the less of both\n"
        "Indices count targets and mounts from 0. No mount is usable: exit status 3.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

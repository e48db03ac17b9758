/// `boresight aim`: where to look, from a file of points.
#include "aim_picture.h"
#include "command.h"
#include "facts.h"
#include "measure.h"
#include "point_options.h"

#include "aim/orient.h"
#include "sphere/cone.h"
#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/voronoi_circle.h"

#include <math.h>
#include <stdlib.h>

struct settings {
    struct point_options points;
    struct triple up;
    int method;
    bool json;
    struct picture_options picture;
    struct bounds bounds;
};

typedef enum cone_status solve_function(const struct points *points, struct cone_result *result);

static enum cone_status solve_pivot(const struct points *points, struct cone_result *result) {
    const size_t bytes = CONE_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        return CONE_ERROR_WORKSPACE;
    }
    const struct cone_options options = {.workspace = workspace, .workspace_bytes = bytes};
    const enum cone_status status =
        cone_narrowest(points->directions, points->count, &options, result);
    free(workspace);
    return status;
}

static enum cone_status solve_shrink(const struct points *points, struct cone_result *result) {
    const size_t bytes = SHRINK_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        return CONE_ERROR_WORKSPACE;
    }
    struct shrink_result shrunk;
    const enum cone_status status =
        shrink_narrowest(points->directions, points->count, workspace, bytes, &shrunk);
    *result = shrunk.cone;
    free(workspace);
    return status;
}

static enum cone_status solve_pyramid(const struct points *points, struct cone_result *result) {
    const size_t bytes = PYRAMID_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        return CONE_ERROR_WORKSPACE;
    }
    struct pyramid_result built;
    const enum cone_status status =
        pyramid_narrowest(points->directions, points->count, workspace, bytes, &built);
    *result = built.cone;
    free(workspace);
    return status;
}

static enum cone_status solve_circle(const struct points *points, bool hull,
                                     struct cone_result *result) {
    const size_t bytes = VORONOI_CIRCLE_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        return CONE_ERROR_WORKSPACE;
    }
    const struct voronoi_circle_options how = {.hull = hull};
    struct voronoi_circle_result read;
    const enum cone_status status =
        voronoi_circle(points->directions, points->count, &how, workspace, bytes, &read);
    *result = read.cone;
    free(workspace);
    return status;
}

static enum cone_status solve_voronoi(const struct points *points, struct cone_result *result) {
    return solve_circle(points, false, result);
}

static enum cone_status solve_hull_voronoi(const struct points *points,
                                           struct cone_result *result) {
    return solve_circle(points, true, result);
}

/// The methods that --method chooses from; method_names holds the same names in the same order.
static const struct method {
    const char *name; ///< as it stands in the results
    solve_function *solve;
} methods[] = {{"pivot", solve_pivot},
               {"pivot", solve_pivot},
               {"shrink", solve_shrink},
               {"voronoi", solve_voronoi},
               {"hull-voronoi", solve_hull_voronoi},
               {"pyramid", solve_pyramid}};
static const char *const method_names[] = {"auto",         "pivot",   "shrink", "voronoi",
                                           "hull-voronoi", "pyramid", NULL};

static const struct option options[] = {
    POINT_OPTIONS(struct settings, points),
    {"--method", "NAME", "auto, pivot, shrink, voronoi, hull-voronoi or pyramid (auto)",
     option_choice, offsetof(struct settings, method), method_names},
    {"--up", "X,Y,Z", "what shall be up in the picture (0,0,1)", option_triple,
     offsetof(struct settings, up), NULL},
    PICTURE_OPTIONS(struct settings, picture),
    OPTION_JSON(struct settings),
};

/// The vector that --up gives, or z. False: told that it is zero.
static bool read_up(const struct command *command, const struct triple *option, struct vec3 *up) {
    static const struct decimal origin[3];
    struct direction direction = {.coarse = {0, 0, 1}};
    if (option->given && !direction_from_decimals(option->component, origin, &direction)) {
        message_command(command->name, "--up: the zero vector has no direction");
        return false;
    }
    *up = direction.coarse;
    return true;
}

/// The half-angle in 10^-12 degrees.
static uint64_t print_cone(struct facts *facts, struct vec3 ahead_q30,
                           const struct points *points) {
    const struct measured_cone cone = measure_cone(ahead_q30, points);
    const char *const why = "the half-angle is not below 90 degrees";
    facts_trillionths(facts, "half_angle_deg", cone.half_angle_pdeg);
    facts_u64(facts, "half_angle_bam32", cone.half_angle_bam32.bam);
    if (cone.half_angle_pdeg < 90U * MEASURE_DEGREE) {
        facts_significant(facts, "image_radius", measure_tangent(cone.half_angle_pdeg), 12);
        facts_significant(facts, "max_distortion", measure_secant(cone.half_angle_pdeg), 12);
    } else {
        facts_null(facts, "image_radius", why);
        facts_null(facts, "max_distortion", why);
    }
    return cone.half_angle_pdeg;
}

/// What is aimed at: by a cone, or a rectangle.
struct aimed {
    const char *method;
    struct picture_axes axes;
    double pan_deg, tilt_deg;
    const uint32_t *support;
    uint32_t support_count;
    uint64_t point_reads;
    const struct rect_frame *rect;          ///< NULL: a cone
    const struct measured_cone *box, *best; ///< of the corners, and without the box; NULL: no box
};

static void print_aimed(struct facts *facts, const struct settings *settings,
                        const struct points *points, const struct aimed *aimed) {
    facts_bool(facts, "feasible", true);
    facts_u64(facts, "count", points->count);
    facts_text(facts, "method", aimed->method);
    facts_vec3(facts, "ahead_q30", aimed->axes.ahead_q30);
    facts_vec3(facts, "right_q30", aimed->axes.right_q30);
    facts_vec3(facts, "up_q30", aimed->axes.up_q30);
    facts_fixed(facts, "pan_deg", aimed->pan_deg, 12);
    facts_fixed(facts, "tilt_deg", aimed->tilt_deg, 12);
    const uint64_t half_angle_pdeg = print_cone(facts, aimed->axes.ahead_q30, points);
    if (aimed->rect != NULL) {
        picture_print_field(facts, &settings->picture, aimed->rect->slope);
    }
    if (aimed->box != NULL) {
        facts_trillionths(facts, "box_half_deg", aimed->box->half_angle_pdeg);
        facts_trillionths(facts, "loss_deg",
                          half_angle_pdeg > aimed->best->half_angle_pdeg
                              ? half_angle_pdeg - aimed->best->half_angle_pdeg
                              : 0U);
    }
    if (aimed->support != NULL) {
        facts_indices(facts, "support", aimed->support, aimed->support_count, point_options_name_of,
                      points);
    }
    facts_u64(facts, "point_reads", aimed->point_reads);
    picture_print_image(facts, &settings->picture, aimed->axes.ahead_q30, aimed->axes.up_q30,
                        half_angle_pdeg, points);
}

static struct aimed aimed_by_cone(const char *method, struct vec3 up,
                                  const struct cone_result *result) {
    const struct orient_axes axes = orient_axes(result->axis_q30, up);
    return (struct aimed){.method = method,
                          .axes = {result->axis_q30, axes.right_q30, axes.up_q30},
                          .pan_deg = measure_pan_deg(result->axis_q30),
                          .tilt_deg = measure_tilt_deg(result->axis_q30),
                          .support = result->support,
                          .support_count = result->support_count,
                          .point_reads = result->point_reads};
}

static void print_infeasible(struct facts *facts, const struct points *points,
                             const struct cone_result *result) {
    facts_bool(facts, "feasible", false);
    facts_u64(facts, "count", points->count);
    if (points->count != 0U) {
        facts_indices(facts, "witness", result->witness, result->witness_count,
                      point_options_name_of, points);
    }
}

static enum exit_status print_result(const struct settings *settings, const struct points *points,
                                     const struct aimed *aimed) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    print_aimed(&facts, settings, points, aimed);
    facts_end(&facts);
    return EXIT_STATUS_OK;
}

static enum exit_status tell_no_memory(const struct command *command, const struct points *points) {
    message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
    return EXIT_STATUS_FAILURE;
}

static enum exit_status aim_rect(const struct command *command, const struct settings *settings,
                                 const struct points *points, const struct cone_result *cone) {
    const struct picture_options *picture = &settings->picture;
    struct rect_frame frame;
    if (!rect_solve(points, picture->width, picture->height, cone->axis_q30, &frame)) {
        return tell_no_memory(command, points);
    }
    // As printed, with 12 decimals: the picture is that of the angles that are read.
    const double scale = 1e12 * MEASURE_DEG_PER_RAD;
    const double pan_deg = round(frame.pan_rad * scale) / 1e12 + 0.0, // no -0
        tilt_deg = round(frame.tilt_rad * scale) / 1e12 + 0.0;
    const double pan_rad = pan_deg / MEASURE_DEG_PER_RAD, tilt_rad = tilt_deg / MEASURE_DEG_PER_RAD;
    frame.slope = rect_slope(points, picture->width, picture->height, pan_rad, tilt_rad);
    const struct aimed aimed = {.method = "rect",
                                .axes = picture_axes(pan_rad, tilt_rad),
                                .pan_deg = pan_deg,
                                .tilt_deg = tilt_deg,
                                .support = frame.support,
                                .support_count = frame.support_count,
                                .point_reads = cone->point_reads + frame.point_reads,
                                .rect = &frame};
    return print_result(settings, points, &aimed);
}

/// Exit 3: the viewpoint lies in the closed box.
static enum exit_status print_box_infeasible(const struct settings *settings,
                                             const struct points *points) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "feasible", false);
    facts_u64(&facts, "count", points->count);
    facts_text(&facts, "why", "the viewpoint lies in the box of the points");
    facts_end(&facts);
    return EXIT_STATUS_INFEASIBLE;
}

static enum exit_status aim_box(const struct command *command, const struct settings *settings,
                                struct vec3 up, const struct points *points,
                                const struct cone_result *cone) {
    const struct method *const method = &methods[settings->method];
    struct vec3 corner[8];
    struct vec3_i64 fine[8];
    struct points corners = {.count = 8, .directions = corner, .fine = fine, .fine_exact = true};
    for (int i = 0; i < 8; i++) {
        struct decimal place[3];
        struct direction direction;
        bounds_corner(&settings->bounds, i, place);
        if (!direction_from_decimals(place, settings->points.viewpoint.component, &direction)) {
            return print_box_infeasible(settings, points);
        }
        corner[i] = direction.coarse;
        fine[i] = direction.fine;
        corners.fine_exact = corners.fine_exact && direction.fine_exact;
    }
    corners.fine_error_rad = corners.fine_exact ? 0 : direction_decimals_error_rad;
    struct cone_result of_box = {0};
    switch (method->solve(&corners, &of_box)) {
    case CONE_OK:
        break;
    case CONE_INFEASIBLE:
        return print_box_infeasible(settings, points);
    default:
        return tell_no_memory(command, points);
    }
    const struct measured_cone box = measure_cone(of_box.axis_q30, &corners),
                               best = measure_cone(cone->axis_q30, points);
    struct aimed aimed = aimed_by_cone(method->name, up, &of_box);
    aimed.support = NULL; // they are corners
    aimed.box = &box;
    aimed.best = &best;
    return print_result(settings, points, &aimed);
}

static enum exit_status aim(const struct command *command, const struct settings *settings,
                            struct vec3 up, const struct points *points) {
    const struct method *const method = &methods[settings->method];
    struct cone_result result = {0};
    struct facts facts;
    const enum cone_status status = method->solve(points, &result);
    switch (status) {
    case CONE_OK:
        if (settings->picture.frame == FRAME_RECT) {
            return aim_rect(command, settings, points, &result);
        }
        if (settings->picture.bounds == BOUNDS_BOX) {
            return aim_box(command, settings, up, points, &result);
        }
        const struct aimed aimed = aimed_by_cone(method->name, up, &result);
        return print_result(settings, points, &aimed);
    case CONE_INFEASIBLE:
    case CONE_EMPTY:
        facts_begin(&facts, stdout, settings->json);
        print_infeasible(&facts, points, &result);
        facts_end(&facts);
        return EXIT_STATUS_INFEASIBLE;
    case CONE_ERROR_WORKSPACE:
        return tell_no_memory(command, points);
    default:
        message_command(command->name, "internal failure %d", (int)status);
        return EXIT_STATUS_FAILURE;
    }
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    struct points_format format;
    struct vec3 up;
    const char *file = NULL;
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      &file, 1, &operands) ||
        !point_options_format(command->name, &settings.points, &format) ||
        !read_up(command, &settings.up, &up)) {
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = picture_options_read(command->name, &format, settings.up.given,
                                                   settings.method != 0, &settings.picture);
    struct points points = {0};
    if (status == EXIT_STATUS_OK) {
        format.bounds = settings.picture.bounds == BOUNDS_BOX ? &settings.bounds : NULL;
        status = points_read(file, &format, &points);
    }
    if (status == EXIT_STATUS_OK) {
        status = aim(command, &settings, up, &points);
    }
    points_free(&points);
    bounds_free(&settings.bounds);
    picture_options_free(&settings.picture);
    return status;
}

const struct command command_aim = {
    .name = "aim",
    .summary = "where to look to see every point, and how wide",
    .operands = "[FILE]",
    .help =
        "Finds the narrowest circular cone from the viewpoint that holds every point: its axis\n"
        "is where the camera should look.\n\n" POINT_OPTIONS_HELP "\n"
        "results:\n"
        "  feasible         yes, or no: then no direction has every point in front of it, the\n"
        "                   exit status is 3, and `witness` names up to four points whose\n"
        "                   positive combinations contain the viewpoint\n"
        "  ahead_q30 right_q30 up_q30\n"
        "                   the camera's axes, unit vectors in Q1.30 (2^30 is one)\n"
        "  pan_deg          clockwise from +y seen from above; 0 at the zenith and the nadir\n"
        "  tilt_deg         upward\n"
        "  half_angle_deg half_angle_bam32\n"
        "                   the largest true angle from ahead_q30 as printed to a point as\n"
        "                   written, rounded up (BAM: 2^32 a turn)\n"
        "  image_radius max_distortion\n"
        "                   its tangent, and one over its cosine; null at 90 degrees and beyond\n"
        "  support          one to three points whose own narrowest cone is this one\n"
        "  point_reads      how many times a point was read in search of the "
        "answer\n\n" PICTURE_HELP,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

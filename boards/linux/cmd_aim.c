/// `boresight aim`: where to look, from a file of points.
#include "command.h"
#include "facts.h"
#include "measure.h"
#include "point_options.h"

#include "aim/orient.h"
#include "sphere/cone.h"
#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/voronoi_circle.h"

#include <stdlib.h>

struct settings {
    struct point_options points;
    struct triple up;
    int method;
    bool json;
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

static void print_cone(struct facts *facts, struct vec3 ahead_q30, const struct points *points) {
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
}

static void print_feasible(struct facts *facts, const char *method, struct vec3 up,
                           const struct points *points, const struct cone_result *result) {
    const struct orient_axes axes = orient_axes(result->axis_q30, up);
    facts_bool(facts, "feasible", true);
    facts_u64(facts, "count", points->count);
    facts_text(facts, "method", method);
    facts_vec3(facts, "ahead_q30", result->axis_q30);
    facts_vec3(facts, "right_q30", axes.right_q30);
    facts_vec3(facts, "up_q30", axes.up_q30);
    facts_fixed(facts, "pan_deg", measure_pan_deg(result->axis_q30), 12);
    facts_fixed(facts, "tilt_deg", measure_tilt_deg(result->axis_q30), 12);
    print_cone(facts, result->axis_q30, points);
    facts_indices(facts, "support", result->support, result->support_count, point_options_name_of,
                  points);
    facts_u64(facts, "point_reads", result->point_reads);
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

static enum exit_status aim(const struct command *command, const struct settings *settings,
                            struct vec3 up, const struct points *points) {
    const struct method *const method = &methods[settings->method];
    struct cone_result result = {0};
    const enum cone_status status = method->solve(points, &result);
    struct facts facts;
    switch (status) {
    case CONE_OK:
        facts_begin(&facts, stdout, settings->json);
        print_feasible(&facts, method->name, up, points, &result);
        facts_end(&facts);
        return EXIT_STATUS_OK;
    case CONE_INFEASIBLE:
    case CONE_EMPTY:
        facts_begin(&facts, stdout, settings->json);
        print_infeasible(&facts, points, &result);
        facts_end(&facts);
        return EXIT_STATUS_INFEASIBLE;
    case CONE_ERROR_WORKSPACE:
        message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
        return EXIT_STATUS_FAILURE;
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
    struct points points;
    enum exit_status status = points_read(file, &format, &points);
    if (status == EXIT_STATUS_OK) {
        status = aim(command, &settings, up, &points);
    }
    points_free(&points);
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
        "  point_reads      how many times a point was read in search of the answer\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

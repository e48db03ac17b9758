/// `boresight solid`: convex hull and smallest sphere of points in space.
#include "command.h"
#include "facts.h"
#include "places.h"
#include "point_options.h"

#include "solid/solid_sphere.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct settings {
    int input;
    bool named, json;
    const char *method;
};

static const char *const inputs[] = {"xyz", "q30", NULL};

static const struct option options[] = {
    {"--input", "xyz|q30", "what a line holds: decimals or int32 (xyz)", option_choice,
     offsetof(struct settings, input), inputs},
    {"--named", NULL, "a name stands before the numbers of each line", option_flag,
     offsetof(struct settings, named), NULL},
    {"--method", "METHOD", "how to search (see below)", option_text,
     offsetof(struct settings, method), NULL},
    OPTION_JSON(struct settings),
};

static const char *const hull_methods[] = {"caps", "levine", "wrap", NULL};
static const char *const sphere_methods[] = {"pivot", "levine", "unsorted", NULL};

/// The index of the method's name, 0 without one; -1: there is none of that name.
static int method_of(const char *const *names, const char *name) {
    for (int i = 0; names[i] != NULL; i++) {
        if (name == NULL || strcmp(name, names[i]) == 0) {
            return i;
        }
    }
    return -1;
}

static void print_faces(struct facts *facts, const struct solid_hull *hull) {
    if (facts->as_json) {
        json_key(&facts->json, "faces");
        json_begin_array(&facts->json);
        for (uint32_t f = 0; f < hull->face_count; f++) {
            json_begin_array(&facts->json);
            for (int k = 0; k < 3; k++) {
                json_u64(&facts->json, hull->faces[f].vertex[k]);
            }
            json_end_array(&facts->json);
        }
        json_end_array(&facts->json);
        return;
    }
    fprintf(facts->stream, "%-18s", "faces");
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint32_t *const v = hull->faces[f].vertex;
        fprintf(facts->stream, "%s%" PRIu32 "-%" PRIu32 "-%" PRIu32, f == 0U ? "" : " ", v[0], v[1],
                v[2]);
    }
    fputs(hull->face_count == 0U ? "none\n" : "\n", facts->stream);
}

static void begin(struct facts *facts, const struct settings *settings,
                  const struct points *points) {
    facts_begin(facts, stdout, settings->json);
    facts_u64(facts, "count", points->count);
    facts_bool(facts, "exact", points->places_exact);
}

static bool print_hull(const struct settings *settings, const struct points *points, int method,
                       void *workspace, size_t bytes) {
    struct solid_hull hull;
    if (solid_hull_find(points->directions, points->count, (enum solid_hull_method)method,
                        workspace, bytes, &hull) != SOLID_HULL_OK) {
        return false;
    }
    struct facts facts;
    begin(&facts, settings, points);
    facts_u64(&facts, "dimension", hull.dimension);
    facts_indices(&facts, "vertices", hull.vertices, hull.vertex_count, point_options_name_of,
                  points);
    print_faces(&facts, &hull);
    facts_u64(&facts, "side_tests", hull.side_tests);
    facts_end(&facts);
    return true;
}

/// The largest distance from the centre as printed to a point as written, rounded up.
static double radius_about(const struct points *points, const double center[3]) {
    long double farthest = 0;
    for (uint32_t i = 0; i < points->count; i++) {
        const struct vec3 p = points->directions[i];
        const long double d[3] = {p.x * points->unit - (long double)center[0],
                                  p.y * points->unit - (long double)center[1],
                                  p.z * points->unit - (long double)center[2]};
        farthest = fmaxl(farthest, sqrtl(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]));
    }
    long double size = 0;
    for (int axis = 0; axis < 3; axis++) {
        size = fmaxl(size, fabsl((long double)center[axis]));
    }
    // A few roundings of long doubles, and half a unit an axis where the points were rounded.
    const long double bound = farthest + (farthest + size) * 0x1p-60L +
                              (points->places_exact ? 0.0L : 0.87L * points->unit);
    const double radius = (double)bound;
    return points->count > 1U && farthest > 0 && (long double)radius < bound
               ? nextafter(radius, INFINITY)
               : (farthest > 0 ? radius : 0.0);
}

static void print_center(struct facts *facts, const char text[3][40]) {
    if (facts->as_json) {
        json_key(&facts->json, "center");
        json_begin_array(&facts->json);
        for (int axis = 0; axis < 3; axis++) {
            json_number(&facts->json, text[axis]);
        }
        json_end_array(&facts->json);
    } else {
        fprintf(facts->stream, "%-18s%s %s %s\n", "center", text[0], text[1], text[2]);
    }
}

static bool print_sphere(const struct settings *settings, struct points *points, int method,
                         void *workspace, size_t bytes) {
    // Small integers get binary places, so that the centre's 2^-30 of a unit is fine.
    places_spread(points, INT32_MAX);
    struct solid_sphere sphere;
    const enum solid_sphere_status status =
        method == 0
            ? solid_sphere_find(points->directions, points->count, workspace, bytes, &sphere)
            : solid_sphere_by_trial(points->directions, points->count,
                                    method == 1 ? SOLID_SPHERE_SHARPEST_FIRST
                                                : SOLID_SPHERE_AS_LISTED,
                                    0, workspace, bytes, &sphere);
    if (status != SOLID_SPHERE_OK) {
        return false;
    }
    const int64_t q30[3] = {sphere.center_q30.x, sphere.center_q30.y, sphere.center_q30.z};
    char text[3][40];
    double center[3];
    for (int axis = 0; axis < 3; axis++) {
        snprintf(text[axis], sizeof text[axis], "%.15Lg",
                 (long double)q30[axis] * 0x1p-30L * points->unit);
        center[axis] = strtod(text[axis], NULL);
    }
    struct facts facts;
    begin(&facts, settings, points);
    print_center(&facts, text);
    facts_significant(&facts, "radius", radius_about(points, center), 17);
    facts_indices(&facts, "support", sphere.support, sphere.support_count, point_options_name_of,
                  points);
    facts_u64(&facts, "spheres_created", sphere.spheres_created);
    facts_u64(&facts, "spheres_tested", sphere.spheres_tested);
    facts_u64(&facts, "point_tests", sphere.point_tests);
    facts_end(&facts);
    return true;
}

static enum exit_status solve(const struct command *command, const struct settings *settings,
                              struct points *points, bool hull, int method) {
    const size_t bytes = SOLID_SPHERE_TRIAL_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL) {
        message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
        return EXIT_STATUS_FAILURE;
    }
    const bool good = hull ? print_hull(settings, points, method, workspace, bytes)
                           : print_sphere(settings, points, method, workspace, bytes);
    free(workspace);
    if (!good) {
        message_command(command->name, "internal failure");
        return EXIT_STATUS_FAILURE;
    }
    return EXIT_STATUS_OK;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *operand[2] = {NULL, NULL};
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      operand, 2, &operands)) {
        return EXIT_STATUS_USAGE;
    }
    const bool hull = operands != 0U && strcmp(operand[0], "hull") == 0;
    if (!hull && (operands == 0U || strcmp(operand[0], "sphere") != 0)) {
        message_command(command->name, "needs `hull` or `sphere` first");
        return EXIT_STATUS_USAGE;
    }
    const int method = method_of(hull ? hull_methods : sphere_methods, settings.method);
    if (method < 0) {
        message_command(command->name, "--method %s: must be one of %s",
                        message_quoted(settings.method, strlen(settings.method)).text,
                        hull ? "caps, levine, wrap" : "pivot, levine, unsorted");
        return EXIT_STATUS_USAGE;
    }
    const struct points_format format = {.input = settings.input == 0 ? POINTS_XYZ : POINTS_Q30,
                                         .named = settings.named,
                                         .places = true};
    struct points points;
    const char *const file = operand[1];
    enum exit_status status = points_read(file, &format, &points);
    if (status == EXIT_STATUS_OK && points.count == 0U) {
        message_at(file == NULL || strcmp(file, "-") == 0 ? "stdin" : file, 0, "no points");
        status = EXIT_STATUS_USAGE;
    }
    if (status == EXIT_STATUS_OK && points.count > SOLID_HULL_COUNT_MAX) {
        message_command(command->name, "more than %lu points", (unsigned long)SOLID_HULL_COUNT_MAX);
        status = EXIT_STATUS_USAGE;
    }
    if (status == EXIT_STATUS_OK) {
        status = solve(command, &settings, &points, hull, method);
    }
    points_free(&points);
    return status;
}

const struct command command_solid = {
    .name = "solid",
    .summary = "convex hull or smallest sphere of points in space",
    .operands = "hull|sphere [FILE]",
    .help =
        "Finds the convex hull, or the smallest sphere, of points in space.\n\n"
        "FILE holds one point a line; without it, or with -, stdin is read. Columns are apart by\n"
        "blanks, tabs or one comma; # starts a comment; blank lines are skipped.\n"
        "  --input xyz    x y z in any one unit. Where all are whole multiples of one power of "
        "ten\n"
        "                 that fit int32, every decision is exact for the numbers as written\n"
        "                 (`exact yes`); else they are rounded to 30 bits of the largest\n"
        "  --input q30    three int32, used as given\n"
        "  --method       hull: caps (default); for comparison levine, wrap (Chand and Kapur).\n"
        "                 sphere: pivot (default); for comparison levine (sharpest vertex of the\n"
        "                 hull first), unsorted\n"
        "Indices in the results count points from 0.\n\n"
        "results of `solid hull`:\n"
        "  dimension        3; 2 if all points are in one plane, 1 on one line, 0 equal\n"
        "  vertices         ascending; of a plane set the corners in order\n"
        "  faces            triangles, counter-clockwise from outside; only of dimension 3\n"
        "  side_tests       points tested against planes\n"
        "results of `solid sphere`:\n"
        "  center, radius   the sphere as printed holds every point\n"
        "  support          one to four points that hold it\n"
        "  spheres_created, spheres_tested, point_tests   what the search took\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

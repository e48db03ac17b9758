/// `boresight hull`: the extreme directions of a set of points.
#include "command.h"
#include "facts.h"
#include "point_options.h"

#include "sphere/hull.h"

#include <stdlib.h>

struct settings {
    struct point_options points;
    bool json;
};

static const struct option options[] = {
    POINT_OPTIONS(struct settings, points),
    OPTION_JSON(struct settings),
};

static enum exit_status print_hull(const struct settings *settings, const struct points *points,
                                   enum hull_status status, const struct hull_result *result) {
    const bool hemispherical = status == HULL_OK;
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "hemispherical", hemispherical);
    facts_u64(&facts, "count", points->count);
    if (hemispherical) {
        facts_indices(&facts, "hull", result->vertices, result->vertex_count, point_options_name_of,
                      points);
    } else {
        facts_indices(&facts, "witness", result->witness, result->witness_count,
                      point_options_name_of, points);
    }
    facts_end(&facts);
    return hemispherical ? EXIT_STATUS_OK : EXIT_STATUS_INFEASIBLE;
}

static enum exit_status hull(const struct command *command, const void *settings,
                             const struct points *points) {
    const size_t bytes = HULL_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
        return EXIT_STATUS_FAILURE;
    }
    struct hull_result result = {0};
    const enum hull_status status =
        hull_spherical(points->directions, points->count, workspace, bytes, &result);
    enum exit_status exit_status = EXIT_STATUS_FAILURE;
    if (status == HULL_OK || status == HULL_NOT_HEMISPHERICAL || status == HULL_EMPTY) {
        exit_status = print_hull(settings, points, status, &result);
    } else {
        message_command(command->name, "internal failure %d", (int)status);
    }
    free(workspace);
    return exit_status;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    return point_options_run(command, argc, argv, &settings, &settings.points, hull);
}

const struct command command_hull = {
    .name = "hull",
    .summary = "the extreme directions of a set of points, in order",
    .operands = "[FILE]",
    .help = "Finds the spherical convex hull of the points as seen from the "
            "viewpoint.\n\n" POINT_OPTIONS_HELP "\n"
            "results:\n"
            "  hemispherical    yes, or no: then no direction has every point in front of it, the\n"
            "                   exit status is 3, and `witness` names up to four points whose\n"
            "                   positive combinations contain the viewpoint\n"
            "  hull             the extreme directions clockwise as seen from outside the sphere,\n"
            "                   from the smallest index on; of equal directions the first, and no\n"
            "                   point that lies between two others\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

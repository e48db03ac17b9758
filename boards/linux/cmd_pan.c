/// `boresight pan`: the directions between objects as their weights change.
#include "command.h"
#include "facts.h"
#include "measure.h"
#include "point_options.h"
#include "weigh.h"

#include "sphere/cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// As many objects as a command line has room for weights.
enum { OBJECTS_MOST = 256, STEPS_MOST = 1000000 };

struct settings {
    struct point_options points;
    const char *from, *to;
    uint64_t steps;
    int cost;
    bool json;
};

struct object {
    const char *name;
    struct vec3 axis_q30;
};

struct objects {
    uint32_t count;
    struct object object[OBJECTS_MOST];
    double from[OBJECTS_MOST], to[OBJECTS_MOST];
};

static const char *const cost_names[] = {[WEIGH_ONE_MINUS_COS] = "1-cos",
                                         [WEIGH_ANGLE_SQUARED] = "angle2",
                                         [WEIGH_ONE_OVER_COS] = "1/cos",
                                         NULL};

static const struct option options[] = {
    POINT_OPTIONS(struct settings, points),
    {"--from", "W1,W2,...", "the weights to begin with, one for each object", option_text,
     offsetof(struct settings, from), NULL},
    {"--to", "W1,W2,...", "the weights to end with", option_text, offsetof(struct settings, to),
     NULL},
    {"--steps", "N", "print N + 1 directions (10)", option_u64, offsetof(struct settings, steps),
     NULL},
    {"--cost", "COST", "of an angle: 1-cos, angle2 or 1/cos (1-cos)", option_choice,
     offsetof(struct settings, cost), cost_names},
    OPTION_JSON(struct settings),
};

// ---------------------------------------------------------------- weights

/// One weight of a list; *at moves behind it and its comma.
static bool read_weight(const char **at, double *weight) {
    const size_t size = strcspn(*at, ",");
    struct decimal value;
    int64_t millionths = 0;
    if (decimal_read(*at, size, &value) != DECIMAL_OK ||
        !decimal_scale(&value, 1000000, 1, &millionths) || millionths < 0 ||
        millionths > INT64_C(1000000000000)) {
        return false;
    }
    *weight = (double)millionths * 1e-6;
    *at += size;
    return true;
}

/// False: told what is wrong.
static bool read_weights(const char *command, const char *option, const char *text,
                         const struct objects *objects, double *weights) {
    if (text == NULL) {
        message_command(command, "%s W1,W2,... is missing", option);
        return false;
    }
    uint32_t count = 0;
    double most = 0;
    for (const char *at = text;; at++) {
        double weight;
        if (!read_weight(&at, &weight)) {
            message_command(command,
                            "%s %s: weights are numbers from 0 to 1000000, apart by commas", option,
                            message_quoted(text, strlen(text)).text);
            return false;
        }
        if (count < objects->count) {
            weights[count] = weight;
        }
        count++;
        most = fmax(most, weight);
        if (*at == '\0') {
            break;
        }
    }
    if (count != objects->count) {
        message_command(command, "%s %s: %lu weights for %lu objects", option,
                        message_quoted(text, strlen(text)).text, (unsigned long)count,
                        (unsigned long)objects->count);
        return false;
    }
    if (!(most > 0)) {
        message_command(command, "%s: at least one weight must be above 0", option);
        return false;
    }
    return true;
}

// ---------------------------------------------------------------- objects

/// The place of the name, which is added if it is new; OBJECTS_MOST: no room.
static uint32_t find_object(struct objects *objects, const char *name) {
    uint32_t i = 0;
    while (i < objects->count && strcmp(objects->object[i].name, name) != 0) {
        i++;
    }
    if (i == objects->count && i < OBJECTS_MOST) {
        objects->object[objects->count++].name = name;
    }
    return i;
}

static enum exit_status tell_no_memory(const struct command *command, const struct points *points) {
    message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
    return EXIT_STATUS_FAILURE;
}

/// An object that no direction sees whole: its witness are points of the file.
static enum exit_status print_infeasible(const struct settings *settings,
                                         const struct points *points, const char *name,
                                         const uint32_t *indices,
                                         const struct cone_result *result) {
    uint32_t witness[4];
    for (uint32_t i = 0; i < result->witness_count; i++) {
        witness[i] = indices[result->witness[i]];
    }
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "feasible", false);
    facts_text(&facts, "object", name);
    facts_indices(&facts, "witness", witness, result->witness_count, point_options_name_of, points);
    facts_end(&facts);
    return EXIT_STATUS_INFEASIBLE;
}

/// The axis of one object's narrowest cone. member, indices: room for all points.
static enum exit_status solve_object(const struct command *command, const struct settings *settings,
                                     const struct points *points, struct object *object,
                                     struct vec3 *member, uint32_t *indices) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < points->count; i++) {
        if (strcmp(points_name(points, i), object->name) == 0) {
            member[count] = points->directions[i];
            indices[count++] = i;
        }
    }
    const size_t bytes = CONE_WORKSPACE_BYTES(count);
    void *const workspace = malloc(bytes);
    struct cone_result result;
    const struct cone_options cone = {.workspace = workspace,
                                      .workspace_bytes = workspace == NULL ? 0 : bytes};
    const enum cone_status status = cone_narrowest(member, count, &cone, &result);
    free(workspace);
    switch (status) {
    case CONE_OK:
        object->axis_q30 = result.axis_q30;
        return EXIT_STATUS_OK;
    case CONE_INFEASIBLE:
        return print_infeasible(settings, points, object->name, indices, &result);
    default:
        return tell_no_memory(command, points);
    }
}

static enum exit_status solve_objects(const struct command *command,
                                      const struct settings *settings, const struct points *points,
                                      struct objects *objects) {
    for (uint32_t i = 0; i < points->count; i++) {
        if (find_object(objects, points_name(points, i)) == OBJECTS_MOST) {
            message_command(command->name, "more than %d objects", OBJECTS_MOST);
            return EXIT_STATUS_USAGE;
        }
    }
    struct vec3 *const member = malloc((points->count + 1U) * sizeof *member);
    uint32_t *const indices = malloc((points->count + 1U) * sizeof *indices);
    enum exit_status status = EXIT_STATUS_OK;
    if (member == NULL || indices == NULL) {
        status = tell_no_memory(command, points);
    }
    for (uint32_t i = 0; i < objects->count && status == EXIT_STATUS_OK; i++) {
        status = solve_object(command, settings, points, &objects->object[i], member, indices);
    }
    free(member);
    free(indices);
    return status;
}

// ---------------------------------------------------------------- the pan

static void weights_at(const struct objects *objects, uint64_t step, uint64_t steps,
                       double *weights) {
    const double part = steps == 0U ? 0 : (double)step / (double)steps;
    for (uint32_t i = 0; i < objects->count; i++) {
        weights[i] = objects->from[i] * (1 - part) + objects->to[i] * part;
    }
}

static void print_step(const struct settings *settings, const struct objects *objects,
                       const double *weights, struct vec3 ahead_q30) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_reals(&facts, "weights", weights, objects->count);
    facts_vec3(&facts, "ahead_q30", ahead_q30);
    facts_fixed(&facts, "pan_deg", measure_pan_deg(ahead_q30), 12);
    facts_fixed(&facts, "tilt_deg", measure_tilt_deg(ahead_q30), 12);
    facts_end(&facts);
    if (!settings->json) {
        putchar('\n');
    }
}

static enum exit_status print_no_union(const struct settings *settings,
                                       const struct objects *objects, const double *weights) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "feasible", false);
    facts_reals(&facts, "weights", weights, objects->count);
    facts_end(&facts);
    return EXIT_STATUS_INFEASIBLE;
}

/// Directions of every step, worked out before any is printed.
static enum exit_status pan(const struct command *command, const struct settings *settings,
                            const struct points *points, const struct objects *objects) {
    struct vec3 axis_q30[OBJECTS_MOST];
    double weights[OBJECTS_MOST];
    struct vec3 *const ahead_q30 = malloc(((size_t)settings->steps + 1U) * sizeof *ahead_q30);
    if (ahead_q30 == NULL) {
        return tell_no_memory(command, points);
    }
    uint32_t heaviest = 0;
    for (uint32_t i = 0; i < objects->count; i++) {
        axis_q30[i] = objects->object[i].axis_q30;
        heaviest = objects->from[i] > objects->from[heaviest] ? i : heaviest;
    }
    struct vec3 last_q30 = objects->object[heaviest].axis_q30;
    enum exit_status status = EXIT_STATUS_OK;
    for (uint64_t step = 0; step <= settings->steps && status == EXIT_STATUS_OK; step++) {
        weights_at(objects, step, settings->steps, weights);
        if (weigh_directions(axis_q30, weights, objects->count, (enum weigh_cost)settings->cost,
                             last_q30, &last_q30) == WEIGH_INFEASIBLE) {
            status = print_no_union(settings, objects, weights);
        }
        ahead_q30[step] = last_q30; // where all is alike, where it was
    }
    for (uint64_t step = 0; step <= settings->steps && status == EXIT_STATUS_OK; step++) {
        weights_at(objects, step, settings->steps, weights);
        print_step(settings, objects, weights, ahead_q30[step]);
    }
    free(ahead_q30);
    return status;
}

static enum exit_status pan_objects(const struct command *command, const void *context,
                                    const struct points *points) {
    const struct settings *const settings = context;
    if (settings->steps > STEPS_MOST) {
        message_command(command->name, "--steps: at most %d", STEPS_MOST);
        return EXIT_STATUS_USAGE;
    }
    static struct objects objects;
    objects.count = 0;
    if (points->count == 0U) {
        message_command(command->name, "there are no objects");
        return EXIT_STATUS_USAGE;
    }
    const enum exit_status status = solve_objects(command, settings, points, &objects);
    if (status != EXIT_STATUS_OK) {
        return status;
    }
    if (!read_weights(command->name, "--from", settings->from, &objects, objects.from) ||
        !read_weights(command->name, "--to", settings->to, &objects, objects.to)) {
        return EXIT_STATUS_USAGE;
    }
    return pan(command, settings, points, &objects);
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {.steps = 10, .points = {.named = true}};
    return point_options_run(command, argc, argv, &settings, &settings.points, pan_objects);
}

const struct command command_pan = {
    .name = "pan",
    .summary = "the directions of a pan between objects",
    .operands = "[FILE]",
    .help =
        "Looks from some objects to others: the first column of FILE names the object that a\n"
        "point belongs to. Each object has the axis of its own narrowest cone; with weights, one\n"
        "looks where the weighted sum of what each costs at its angle t is least, and as the\n"
        "weights change evenly from --from to --to, so does that direction. The objects together\n"
        "need no direction that sees them all.\n\n" POINT_OPTIONS_HELP "\n"
        "costs:\n"
        "  1-cos            one answer everywhere, and smooth; where the weighted axes cancel,\n"
        "                   the last direction is kept\n"
        "  angle2           constant speed between two objects; of objects beyond half a sphere\n"
        "                   there may be several minima, of which the lowest is taken\n"
        "  1/cos            the distortion of the picture at the axes: only where a direction\n"
        "                   has all axes of positive weight in front, else exit status 3\n"
        "results, for each of N + 1 weightings (with --json an object a line):\n"
        "  weights          in the order in which the objects first appear\n"
        "  ahead_q30 pan_deg tilt_deg\n"
        "                   where to look\n"
        "An object that no direction sees whole is named, with a witness, and the exit status\n"
        "is 3.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

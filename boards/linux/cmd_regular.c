/// `boresight regular`: directions from which nothing lines up by accident.
#include "command.h"
#include "decimal.h"
#include "facts.h"
#include "regular_file.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct settings {
    struct regular_options how;
    bool weighted, json;
    int input;
};

static const char *const inputs[] = {"auto", "lines", "obj", NULL};

static const struct option options[] = {
    {"--input", "auto|lines|obj",
     "an item a line, or a Wavefront OBJ; auto (the default) goes by .obj and .scene",
     option_choice, offsetof(struct settings, input), inputs},
    {"--buckets", NULL, "decisions and widest gaps by buckets instead of sorting", option_flag,
     offsetof(struct settings, how.buckets), NULL},
    {"--small", NULL, "points3-plane compute: O(n^3) time without hashing", option_flag,
     offsetof(struct settings, how.small), NULL},
    {"--cylinder", NULL, "optimize between planes: the thinnest anchored cylinder, in little space",
     option_flag, offsetof(struct settings, how.cylinder), NULL},
    {"--above", NULL, "optimize between planes: only above all of them", option_flag,
     offsetof(struct settings, how.above), NULL},
    {"--weighted", NULL, "points2-line optimize: a weight follows each point's coordinates",
     option_flag, offsetof(struct settings, weighted), NULL},
    OPTION_JSON(struct settings),
};

static const char *const problems[REGULAR_PROBLEMS + 1] = {
    "points2-line",       "points3-line",    "points3-x",          "points3-xy",
    "points3-xyz",        "points3-plane",   "points3-cocircular", "segments2-vertical",
    "segments3-vertical", "segments3-plane", "faces-vertical",     NULL};
static const char *const steps[] = {"decide", "compute", "optimize", NULL};

/// The index of a word in a list; -1: told on stderr.
static int choose(const struct command *command, const char *what, const char *const *names,
                  const char *word) {
    for (int i = 0; word != NULL && names[i] != NULL; i++) {
        if (strcmp(word, names[i]) == 0) {
            return i;
        }
    }
    if (word == NULL) {
        message_command(command->name, "no %s; see 'boresight help %s'", what, command->name);
    } else {
        message_command(command->name, "no %s %s; see 'boresight help %s'", what,
                        message_quoted(word, strlen(word)).text, command->name);
    }
    return -1;
}

// ---------------------------------------------------------------- results

static void put_i128(FILE *out, struct i128 value) {
    char text[48];
    size_t at = sizeof text - 1U;
    const bool negative = value.hi < 0;
    struct u128 left = u128_abs(value), digit;
    text[at] = '\0';
    do {
        left = u128_divide(left, u128_of(10), &digit);
        text[--at] = (char)('0' + (int)digit.lo);
    } while (!u128_is_zero(left));
    fprintf(out, "%s%s", negative ? "-" : "", text + at);
}

static void put_vector(FILE *out, const struct vec3_i128 *a, bool planar, const char *between) {
    put_i128(out, a->x);
    fputs(between, out);
    put_i128(out, a->y);
    if (!planar) {
        fputs(between, out);
        put_i128(out, a->z);
    }
}

static void write_vector(struct facts *facts, const char *name, const struct vec3_i128 *a,
                         bool planar) {
    if (!facts->as_json) {
        fprintf(facts->stream, "%-17s ", name);
        put_vector(facts->stream, a, planar, " ");
        fputc('\n', facts->stream);
        return;
    }
    char *text = NULL;
    size_t size = 0;
    FILE *const memory = open_memstream(&text, &size);
    if (name != NULL) {
        json_key(&facts->json, name);
    }
    if (memory != NULL) {
        put_vector(memory, a, planar, ", ");
        fclose(memory);
        // The numbers of an array, as one text: more digits than a double has.
        json_begin_array(&facts->json);
        json_number(&facts->json, text);
        json_end_array(&facts->json);
        free(text);
    }
}

static void write_rotation(struct facts *facts, const struct vec3_i128 rows[3]) {
    static const char *const names[] = {"x axis", "y axis", "z axis"};
    if (facts->as_json) {
        json_key(&facts->json, "rotation");
        json_begin_array(&facts->json);
    }
    for (int k = 0; k < 3; k++) {
        write_vector(facts, facts->as_json ? NULL : names[k], &rows[k], false);
    }
    if (facts->as_json) {
        json_end_array(&facts->json);
    }
}

/// 18 decimals, rounded down.
static void write_tolerance(struct facts *facts, uint64_t tolerance_turn64) {
    const long double rad = (long double)tolerance_turn64 * (acosl(-1.0L) / 0x1p63L);
    const uint64_t attos = (uint64_t)floorl(rad * 1e18L * (1.0L - 0x1p-62L));
    char text[32];
    snprintf(text, sizeof text, "%" PRIu64 ".%018" PRIu64, attos / UINT64_C(1000000000000000000),
             attos % UINT64_C(1000000000000000000));
    if (facts->as_json) {
        json_key(&facts->json, "tolerance_rad");
        json_number(&facts->json, text);
    } else {
        facts_text(facts, "tolerance_rad", text);
    }
}

static void write_result(const struct settings *settings, enum regular_problem problem,
                         enum regular_step step, const struct regular_result *result) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "regular", result->regular);
    if (!result->regular) {
        facts_indices(&facts, "conflict", result->conflict.index, result->conflict.count, NULL,
                      NULL);
    } else if (step != REGULAR_DECIDE) {
        if (problem == REGULAR_POINTS3_XY || problem == REGULAR_POINTS3_XYZ) {
            write_rotation(&facts, result->rotation);
        } else {
            write_vector(&facts, "direction", &result->direction, regular_is_planar(problem));
        }
        if (step == REGULAR_OPTIMIZE) {
            write_tolerance(&facts, result->tolerance_turn64);
            if (result->tolerance_is_bound) {
                facts_bool(&facts, "tolerance_is_bound", true);
            }
        }
    }
    facts_end(&facts);
}

// ---------------------------------------------------------------- faults

struct job {
    const struct command *command;
    const struct settings *settings;
    enum regular_problem problem;
    enum regular_step step;
    const char *file;
    struct regular_items items;
};

static enum exit_status tell_fault(const struct job *job, enum regular_status status,
                                   const struct regular_result *result) {
    const char *const file = job->file == NULL || strcmp(job->file, "-") == 0 ? "stdin" : job->file;
    const uint32_t *const item = result->conflict.index;
    switch (status) {
    case REGULAR_ERROR_REPEATED:
        message_at(file, job->items.lines[item[1]], "the same point as in line %lu",
                   job->items.lines[item[0]]);
        return EXIT_STATUS_USAGE;
    case REGULAR_ERROR_DEGENERATE:
        message_at(file, job->items.lines[item[0]], "%s",
                   regular_points_of(job->problem) == 2U
                       ? "the segment has no length"
                       : "the points of the face are on one line");
        return EXIT_STATUS_USAGE;
    case REGULAR_ERROR_OPEN:
        message_command(job->command->name, "%s has no %s: it is an open problem",
                        problems[job->problem], steps[job->step]);
        return EXIT_STATUS_USAGE;
    default:
        message_command(job->command->name, "internal failure %d", (int)status);
        return EXIT_STATUS_FAILURE;
    }
}

static enum exit_status solve(const struct job *job) {
    const struct regular_options *const how = &job->settings->how;
    const uint32_t count = job->items.count;
    const uint32_t most = regular_count_max(job->problem, job->step, how);
    if (count > most) {
        message_command(job->command->name, "%" PRIu32 " items: %s %s takes at most %" PRIu32,
                        count, problems[job->problem], steps[job->step], most);
        return EXIT_STATUS_USAGE;
    }
    const uint64_t wanted = regular_workspace_bytes(job->problem, job->step, count, how);
    const size_t bytes = wanted < SIZE_MAX ? (size_t)wanted : SIZE_MAX - 1U;
    void *const workspace = malloc(bytes + 1U);
    if (workspace == NULL) {
        message_command(job->command->name, "no memory: %" PRIu32 " items need %" PRIu64 " bytes",
                        count, wanted);
        return EXIT_STATUS_FAILURE;
    }
    const struct regular_input input = {job->problem, job->items.points, count};
    struct regular_result result;
    const enum regular_status status =
        job->step == REGULAR_DECIDE    ? regular_decide(&input, how, workspace, bytes, &result)
        : job->step == REGULAR_COMPUTE ? regular_compute(&input, how, workspace, bytes, &result)
                                       : regular_optimize(&input, how, workspace, bytes, &result);
    free(workspace);
    if (status != REGULAR_OK && status != REGULAR_NONE) {
        return tell_fault(job, status, &result);
    }
    write_result(job->settings, job->problem, job->step, &result);
    return status == REGULAR_NONE ? EXIT_STATUS_INFEASIBLE : EXIT_STATUS_OK;
}

static bool is_obj(const struct settings *settings, const char *file) {
    const char *const dot = file == NULL ? NULL : strrchr(file, '.');
    return settings->input == 2 || (settings->input == 0 && dot != NULL &&
                                    (strcmp(dot, ".obj") == 0 || strcmp(dot, ".scene") == 0));
}

static bool options_fit(const struct job *job, bool obj) {
    const struct settings *const s = job->settings;
    const char *wrong = NULL;
    if (s->weighted && (job->problem != REGULAR_POINTS2_LINE || job->step != REGULAR_OPTIMIZE)) {
        wrong = "--weighted is for points2-line optimize";
    } else if (s->how.small &&
               (job->problem != REGULAR_POINTS3_PLANE || job->step != REGULAR_COMPUTE)) {
        wrong = "--small is for points3-plane compute";
    } else if ((s->how.cylinder || s->how.above) &&
               (job->step != REGULAR_OPTIMIZE ||
                (job->problem != REGULAR_POINTS3_X && job->problem != REGULAR_POINTS3_PLANE &&
                 job->problem != REGULAR_SEGMENTS3_PLANE &&
                 job->problem != REGULAR_FACES_VERTICAL))) {
        wrong = "--cylinder and --above are for optimize of points3-x, points3-plane, "
                "segments3-plane and faces-vertical";
    } else if (obj && regular_is_planar(job->problem)) {
        wrong = "an OBJ has three coordinates a point, the problem two";
    }
    if (wrong != NULL) {
        message_command(job->command->name, "%s", wrong);
    }
    return wrong == NULL;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {.input = 0};
    const char *operands[3] = {NULL, NULL, NULL};
    size_t operand_count;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      operands, 3, &operand_count)) {
        return EXIT_STATUS_USAGE;
    }
    const int problem = choose(command, "problem", problems, operands[0]);
    const int step = problem < 0 ? -1 : choose(command, "step", steps, operands[1]);
    if (step < 0) {
        return EXIT_STATUS_USAGE;
    }
    struct job job = {.command = command,
                      .settings = &settings,
                      .problem = (enum regular_problem)problem,
                      .step = (enum regular_step)step,
                      .file = operands[2]};
    const bool obj = is_obj(&settings, job.file);
    if (!options_fit(&job, obj)) {
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status =
        regular_file_read(job.file, job.problem, settings.weighted, obj, &job.items);
    if (status == EXIT_STATUS_OK) {
        settings.how.weights = settings.weighted ? job.items.weights : NULL;
        status = solve(&job);
    }
    regular_file_free(&job.items);
    return status;
}

const struct command command_regular = {
    .name = "regular",
    .summary = "directions from which nothing lines up by accident",
    .operands = "PROBLEM decide|compute|optimize [FILE]",
    .help =
        "decide tests the data as they are, projected along z (in the plane along y); compute "
        "finds a\nregular direction in whole numbers; optimize one that may be off by the largest "
        "angle.\n\n"
        "problems, and what must not happen:\n"
        "  points2-line        two points have the same x\n"
        "  points3-line        two points have the same x and y\n"
        "  points3-x           two points have the same x: projected onto the x axis\n"
        "  points3-xy, -xyz    the same x or y (or z): compute and optimize give new axes\n"
        "  points3-plane       two points coincide, or three are on one line\n"
        "  points3-cocircular  two points coincide, or four are on one circle (no optimize)\n"
        "  segments2-vertical  a segment becomes a point\n"
        "  segments3-vertical  a segment becomes a point\n"
        "  segments3-plane     a segment becomes a point, or two are on one line\n"
        "  faces-vertical      a face becomes a line\n\n"
        "A line holds a point (2 or 3 whole numbers within +-1048576), both ends of a segment, or "
        "three\npoints of a face. Of an OBJ (v, f, l), points are its vertices, segments its lines "
        "and the sides\nof its faces, each once; decimals count in units of their last digit.\n\n"
        "results:\n"
        "  regular             nothing lines up\n"
        "  conflict            the items that do, from 0; exit status 3 if no direction helps\n"
        "  direction           to project along (points3-x: onto), not of unit length\n"
        "  rotation            points3-xy and -xyz: the new axes, orthogonal\n"
        "  tolerance_rad       every direction this near is regular, too; rounded down. With "
        "weights a\n                      pair of points keeps weight times as far; its weight is "
        "the larger one\n"
        "  tolerance_is_bound  a larger tolerance may exist\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

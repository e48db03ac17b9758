/// `boresight scene measure FILE`: prints Levine's counters.
#include "facts.h"
#include "scene_command.h"
#include "scene_measure.h"

#include <stddef.h>
#include <stdlib.h>

/// In the order of the thesis' appendix III.
static const struct counter {
    const char *name, *heading;
    size_t offset;
} counters[] = {
    {"front_faces", "FF", offsetof(struct hidden_counters, front_faces)},
    {"start_objects", "OC/I", offsetof(struct hidden_counters, start_objects)},
    {"start_windows", "OW/I", offsetof(struct hidden_counters, start_windows)},
    {"start_edges", "EEC/I", offsetof(struct hidden_counters, start_edges)},
    {"start_intersections", "IC/I", offsetof(struct hidden_counters, start_intersections)},
    {"edges", "ED", offsetof(struct hidden_counters, edges)},
    {"line_objects", "OC/HL", offsetof(struct hidden_counters, line_objects)},
    {"line_windows", "OW/HL", offsetof(struct hidden_counters, line_windows)},
    {"line_edges", "EEC/HL", offsetof(struct hidden_counters, line_edges)},
    {"line_intersections", "IC/HL", offsetof(struct hidden_counters, line_intersections)},
    {"line_actual", "AI/HL", offsetof(struct hidden_counters, line_actual)},
    {"clipped_pairs", "clipped", offsetof(struct hidden_counters, clipped_pairs)},
};
#define COUNTERS (sizeof counters / sizeof *counters)

/// The last one is of the segments.
static uint64_t value(const struct scene_count *count, size_t which) {
    return which == COUNTERS ? count->segments
                             : *(const uint64_t *)(const void *)((const char *)&count->counters +
                                                                 counters[which].offset);
}

static const char *const turn_names[] = {"yaw", "pitch"};

static double mean(const struct scene_count *views, size_t which) {
    uint64_t sum = 0;
    for (uint32_t i = 0; i < SCENE_TURN_VIEWS; i++) {
        sum += value(&views[i], which);
    }
    return (double)sum / SCENE_TURN_VIEWS;
}

// ---------------------------------------------------------------- as JSON lines

static void print_json_view(int turn, uint32_t degrees, const struct scene_count *count) {
    struct facts facts;
    facts_begin(&facts, stdout, true);
    facts_text(&facts, "turn", turn_names[turn]);
    facts_u64(&facts, "degrees", degrees);
    for (size_t k = 0; k <= COUNTERS; k++) {
        facts_u64(&facts, k < COUNTERS ? counters[k].name : "segments", value(count, k));
    }
    facts_end(&facts);
}

static void print_json_mean(int turn, const struct scene_measure *m) {
    struct facts facts;
    facts_begin(&facts, stdout, true);
    facts_text(&facts, "turn", turn_names[turn]);
    facts_u64(&facts, "mean_of", SCENE_TURN_VIEWS);
    for (size_t k = 0; k <= COUNTERS; k++) {
        facts_fixed(&facts, k < COUNTERS ? counters[k].name : "segments", mean(m->view[turn], k),
                    6);
    }
    facts_u64(&facts, "objects", m->objects);
    facts_u64(&facts, "planes", m->planes);
    facts_end(&facts);
}

// ---------------------------------------------------------------- as a table

static void print_heading(void) {
    printf("turn    deg");
    for (size_t k = 0; k < COUNTERS; k++) {
        printf(" %9s", counters[k].heading);
    }
    printf("  segments\n");
}

static void print_view(int turn, uint32_t degrees, const struct scene_count *count) {
    printf("%-6s%5u", turn_names[turn], degrees);
    for (size_t k = 0; k <= COUNTERS; k++) {
        printf(" %9llu", (unsigned long long)value(count, k));
    }
    putchar('\n');
}

static void print_mean(int turn, const struct scene_measure *m) {
    printf("%-6s%5s", turn_names[turn], "mean");
    for (size_t k = 0; k <= COUNTERS; k++) {
        printf(" %9.2f", mean(m->view[turn], k));
    }
    putchar('\n');
}

enum exit_status scene_command_measure(const struct command *command,
                                       const struct scene_settings *settings,
                                       const struct tree *tree, const char *file) {
    double distance = 1.25;
    if (settings->distance != NULL &&
        !option_positive(command->name, "--distance", settings->distance, &distance)) {
        return EXIT_STATUS_USAGE;
    }
    struct scene_measure *const m = malloc(sizeof *m);
    if (m == NULL) {
        message_at(file, 0, "no memory to measure this scene");
        return EXIT_STATUS_FAILURE;
    }
    const enum exit_status status = scene_measure(tree, file, distance, m);
    if (status == EXIT_STATUS_OK && !settings->json) {
        printf("objects %u, planes between them %u\n", m->objects, m->planes);
        print_heading();
    }
    for (int turn = 0; turn < (int)SCENE_TURNS && status == EXIT_STATUS_OK; turn++) {
        for (uint32_t i = 0; i < SCENE_TURN_VIEWS; i++) {
            (settings->json ? print_json_view : print_view)(turn, i, &m->view[turn][i]);
        }
        (settings->json ? print_json_mean : print_mean)(turn, m);
    }
    free(m);
    return status;
}

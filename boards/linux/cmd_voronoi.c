/// `boresight voronoi`: the spherical Voronoi diagram of a set of points.
#include "command.h"
#include "facts.h"
#include "point_options.h"

#include "sphere/voronoi.h"

#include <inttypes.h>
#include <stdlib.h>

struct settings {
    struct point_options points;
    bool closest;
    int construction; ///< 0: insert, 1: merge
    bool json;
};

static const char *const constructions[] = {"insert", "merge", NULL};

static const struct option options[] = {
    POINT_OPTIONS(struct settings, points),
    {"--closest", NULL, "each region holds what is closest to its site, instead of farthest",
     option_flag, offsetof(struct settings, closest), NULL},
    {"--construction", "insert|merge", "how to build it (insert); both give the same",
     option_choice, offsetof(struct settings, construction), constructions},
    OPTION_JSON(struct settings),
};

// ---------------------------------------------------------------- as JSON

static void write_list(struct json *json, const char *name, const uint32_t *list, uint32_t count) {
    json_key(json, name);
    json_begin_array(json);
    for (uint32_t i = 0; i < count; i++) {
        json_u64(json, list[i]);
    }
    json_end_array(json);
}

static void write_vertex(struct json *json, const struct voronoi_result *result, uint32_t v) {
    const struct voronoi_vertex *const vertex = &result->vertices[v];
    json_begin_object(json);
    json_key(json, "at_q30");
    json_begin_array(json);
    json_i64(json, vertex->at_q30.x);
    json_i64(json, vertex->at_q30.y);
    json_i64(json, vertex->at_q30.z);
    json_end_array(json);
    write_list(json, "sites", result->vertex_sites + vertex->first, vertex->count);
    json_end_object(json);
}

/// How many ends an edge has.
static uint32_t ends_of(const struct voronoi_edge *edge) {
    return edge->vertex[0] == VORONOI_NONE ? 0U : 2U;
}

static void write_json(struct facts *facts, const struct voronoi_result *result) {
    struct json *const json = &facts->json;
    write_list(json, "sites", result->sites, result->site_count);
    json_key(json, "vertices");
    json_begin_array(json);
    for (uint32_t v = 0; v < result->vertex_count; v++) {
        write_vertex(json, result, v);
    }
    json_end_array(json);
    json_key(json, "edges");
    json_begin_array(json);
    for (uint32_t e = 0; e < result->edge_count; e++) {
        const struct voronoi_edge *const edge = &result->edges[e];
        json_begin_object(json);
        write_list(json, "sites", edge->site, 2);
        write_list(json, "vertices", edge->vertex, ends_of(edge));
        json_end_object(json);
    }
    json_end_array(json);
}

// ---------------------------------------------------------------- as text

static void write_text(struct facts *facts, const struct points *points,
                       const struct voronoi_result *result) {
    FILE *const out = facts->stream;
    facts_indices(facts, "sites", result->sites, result->site_count, point_options_name_of, points);
    facts_u64(facts, "vertices", result->vertex_count);
    facts_u64(facts, "edges", result->edge_count);
    for (uint32_t v = 0; v < result->vertex_count; v++) {
        const struct voronoi_vertex *const vertex = &result->vertices[v];
        const struct vec3 at = vertex->at_q30;
        fprintf(out, "vertex %-10" PRIu32 " %" PRId32 " %" PRId32 " %" PRId32 "  sites", v, at.x,
                at.y, at.z);
        for (uint32_t i = 0; i < vertex->count; i++) {
            fprintf(out, " %" PRIu32, result->vertex_sites[vertex->first + i]);
        }
        fputc('\n', out);
    }
    for (uint32_t e = 0; e < result->edge_count; e++) {
        const struct voronoi_edge *const edge = &result->edges[e];
        fprintf(out, "edge %-12" PRIu32 " sites %" PRIu32 " %" PRIu32, e, edge->site[0],
                edge->site[1]);
        if (ends_of(edge) == 0U) {
            fputs("  a whole great circle\n", out);
        } else {
            fprintf(out, "  vertices %" PRIu32 " %" PRIu32 "\n", edge->vertex[0], edge->vertex[1]);
        }
    }
}

static enum exit_status draw(const struct command *command, const void *context,
                             const struct points *points) {
    const struct settings *const settings = context;
    const size_t bytes = VORONOI_WORKSPACE_BYTES(points->count);
    void *const workspace = malloc(bytes);
    if (workspace == NULL && bytes != 0U) {
        message_command(command->name, "no memory for %lu points", (unsigned long)points->count);
        return EXIT_STATUS_FAILURE;
    }
    const struct voronoi_options how = {.closest = settings->closest,
                                        .merge = settings->construction != 0};
    struct voronoi_result result;
    const enum voronoi_status status =
        voronoi_diagram(points->directions, points->count, &how, workspace, bytes, &result);
    if (status == VORONOI_OK || status == VORONOI_EMPTY) {
        struct facts facts;
        facts_begin(&facts, stdout, settings->json);
        if (settings->json) {
            write_json(&facts, &result);
        } else {
            write_text(&facts, points, &result);
        }
        facts_end(&facts);
    } else {
        message_command(command->name, "internal failure %d", (int)status);
    }
    free(workspace);
    return status == VORONOI_OK || status == VORONOI_EMPTY ? EXIT_STATUS_OK : EXIT_STATUS_FAILURE;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    return point_options_run(command, argc, argv, &settings, &settings.points, draw);
}

const struct command command_voronoi = {
    .name = "voronoi",
    .summary = "which point is farthest, or closest, in every direction",
    .operands = "[FILE]",
    .help = "Finds the spherical farthest-point (or closest-point) Voronoi diagram of the "
            "directions of\nthe points from the viewpoint, on the whole sphere.\n\n" //
    POINT_OPTIONS_HELP "\n"
            "results:\n"
            "  sites            of each direction the first point; each has a region\n"
            "  vertices         where three regions or more meet: a unit vector in Q1.30, and\n"
            "                   the sites of the regions\n"
            "  edges            between the regions of two sites, from vertex to vertex; of two\n"
            "                   sites it is a whole great circle without vertices\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

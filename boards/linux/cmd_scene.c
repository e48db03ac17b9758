/// `boresight scene`: build a sphere tree from a scene, tell about it, aim at what it holds, draw
/// it.
#include "command.h"
#include "facts.h"
#include "measure.h"
#include "scene_build.h"
#include "scene_file.h"
#include "scene_render.h"

#include "aim/orient.h"
#include "scene/scene_aim.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct settings {
    struct triple viewpoint, up, aim;
    const char *output, *focal_px, *coarse_px, *fov, *size, *targets;
    int method; ///< of render
    bool points, json;
};

static const char *const render_methods[] = {"clip", "levine", NULL};

static const struct option options[] = {
    {"-o", "FILE", "build: where to write the tree; render: the picture, .svg or .png", option_text,
     offsetof(struct settings, output), NULL},
    {"--coarse-px", "PX", "build: clusters below that radius are their centre (0.5; 0: never)",
     option_text, offsetof(struct settings, coarse_px), NULL},
    {"--points", NULL, "build: only points; leave faces and lines out", option_flag,
     offsetof(struct settings, points), NULL},
    {"--viewpoint", "X,Y,Z", "aim, render: where the viewer is (0,0,0)", option_triple,
     offsetof(struct settings, viewpoint), NULL},
    {"--up", "X,Y,Z", "aim, render: what shall be up in the picture (0,0,1)", option_triple,
     offsetof(struct settings, up), NULL},
    {"--focal-px", "PX", "aim: at the resolution of a camera with that focal length", option_text,
     offsetof(struct settings, focal_px), NULL},
    {"--aim", "X,Y,Z", "render: the place to look at (the targets in sight)", option_triple,
     offsetof(struct settings, aim), NULL},
    {"--fov", "DEG", "render: the angle of the picture's width (60)", option_text,
     offsetof(struct settings, fov), NULL},
    {"--size", "WxH", "render: of the picture in pixels (1280x720)", option_text,
     offsetof(struct settings, size), NULL},
    {"--targets", "FILE", "render: places to aim at, besides the scene's points", option_text,
     offsetof(struct settings, targets), NULL},
    {"--method", "clip|levine", "render: how hidden lines are found (clip)", option_choice,
     offsetof(struct settings, method), render_methods},
    OPTION_JSON(struct settings),
};

/// A number of pixels as 1/256: 0 to 65,536 (below 2^24). False: told why not.
static bool read_px(const struct command *command, const char *name, const char *text,
                    uint32_t *px_q8) {
    struct decimal value;
    int64_t scaled = -1;
    if (decimal_read(text, strlen(text), &value) != DECIMAL_OK ||
        !decimal_scale(&value, 256, 1, &scaled) || scaled < 0 || scaled > 1 << 24) {
        message_command(command->name, "%s %s: needs a number of pixels from 0 to 65536", name,
                        message_quoted(text, strlen(text)).text);
        return false;
    }
    *px_q8 = (uint32_t)scaled;
    return true;
}

static enum exit_status build(const struct command *command, const struct settings *settings,
                              const char *file) {
    struct scene_build_options build_options = scene_build_default;
    unsigned long line = 0;
    build_options.fault_line = &line;
    if (settings->output == NULL) {
        message_command(command->name, "build: -o FILE says where to write the tree");
        return EXIT_STATUS_USAGE;
    }
    if (settings->coarse_px != NULL &&
        !read_px(command, "--coarse-px", settings->coarse_px, &build_options.coarse_px_q8)) {
        return EXIT_STATUS_USAGE;
    }
    struct scene_text scene;
    enum exit_status status = scene_text_read(file, !settings->points, &scene);
    void *block = NULL;
    size_t size = 0;
    if (status == EXIT_STATUS_OK) {
        const char *const name = file == NULL || strcmp(file, "-") == 0 ? "stdin" : file;
        switch (scene_build(&scene, &build_options, &block, &size)) {
        case SCENE_BUILD_OK:
            status = scene_file_write(settings->output, block, size);
            break;
        case SCENE_BUILD_NO_MEMORY:
            message_at(name, 0, "no memory for the tree of this scene");
            status = EXIT_STATUS_FAILURE;
            break;
        case SCENE_BUILD_TOO_DEEP:
            message_at(name, line, "too deep: with this object the tree has more than %d levels",
                       (int)TREE_LEVELS_MAX);
            status = EXIT_STATUS_USAGE;
            break;
        default:
            message_at(name, 0, "the tree would be larger than 4 GiB");
            status = EXIT_STATUS_USAGE;
            break;
        }
    }
    free(block);
    scene_text_free(&scene);
    return status;
}

static double unit_of(const struct tree *tree) {
    double unit;
    memcpy(&unit, tree->header->unit_double, sizeof unit);
    return unit;
}

static void print_shapes(struct facts *facts, const struct tree *tree) {
    const struct tree_header *const h = tree->header;
    uint32_t objects = 0, solids = 0, elements[2] = {0, 0};
    for (uint32_t i = 0; i < h->part_count; i++) {
        objects += tree->parts[i].name != TREE_NONE ? 1U : 0U;
    }
    for (uint32_t i = 0; i < h->shape_count; i++) {
        solids += tree->shapes[i].kind == TREE_SOLID ? 1U : 0U;
    }
    for (uint32_t i = 0; i < h->element_count; i++) {
        elements[tree->elements[i].kind]++;
    }
    facts_u64(facts, "objects", objects);
    facts_u64(facts, "solids", solids);
    facts_u64(facts, "faces", elements[TREE_FACE]);
    facts_u64(facts, "lines", elements[TREE_LINE]);
}

static enum exit_status info(const struct settings *settings, const struct tree *tree) {
    const struct tree_header *const h = tree->header;
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_u64(&facts, "bytes", h->size_bytes);
    facts_u64(&facts, "nodes", h->node_count);
    facts_u64(&facts, "descriptions", h->description_count);
    facts_u64(&facts, "points", h->point_count);
    facts_u64(&facts, "levels", h->level_count);
    print_shapes(&facts, tree);
    facts_significant(&facts, "unit", unit_of(tree), 17);
    if (h->node_count != 0U) {
        const struct tree_node *const root = &tree->nodes[0];
        facts_significant(&facts, "center_x", root->x * unit_of(tree), 12);
        facts_significant(&facts, "center_y", root->y * unit_of(tree), 12);
        facts_significant(&facts, "center_z", root->z * unit_of(tree), 12);
        facts_significant(&facts, "radius", root->radius * unit_of(tree), 12);
    }
    facts_end(&facts);
    return EXIT_STATUS_OK;
}

/// The viewpoint in whole units of the tree, rounded. False: too far from the scene.
static bool place_viewpoint(const struct triple *viewpoint, const struct tree *tree,
                            struct vec3 *eye) {
    int32_t out[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && viewpoint->given; axis++) {
        const long double value =
            decimal_value(&viewpoint->component[axis]) / (long double)unit_of(tree);
        if (!(fabsl(value) <= (long double)TREE_COORDINATE_MAX)) {
            return false;
        }
        out[axis] = (int32_t)lroundl(value);
    }
    *eye = vec3(out[0], out[1], out[2]);
    return true;
}

/// Points of the finest descriptions.
static uint64_t count_points(const struct tree *tree) {
    uint64_t count = 0;
    const uint32_t nodes = tree->header->node_count;
    unsigned char *const coarse = calloc(nodes + 1U, 1);
    for (uint32_t i = 0; i < nodes && coarse != NULL; i++) {
        const struct tree_node *const node = &tree->nodes[i];
        for (uint32_t k = 0; k < node->description_count; k++) {
            const struct tree_description *const d =
                &tree->descriptions[node->first_description + k];
            const bool finest = !coarse[i] && k + 1U == node->description_count;
            for (uint32_t child = d->first;
                 tree_kind(d) == TREE_NODES && !finest && child < d->first + d->count; child++) {
                coarse[child] = 1;
            }
            count += finest && tree_kind(d) == TREE_POINTS ? d->count : 0U;
        }
    }
    free(coarse);
    return count;
}

static void print_half_angle(struct facts *facts, const struct cone_result *cone) {
    const char *const why = "the half-angle is not below 90 degrees";
    const uint64_t pdeg = measure_pdeg(cone->half_angle_turn64);
    facts_trillionths(facts, "half_angle_deg", pdeg);
    facts_u64(facts, "half_angle_bam32", cone->half_angle_bam32.bam);
    if (pdeg < 90U * MEASURE_DEGREE) {
        facts_significant(facts, "image_radius", measure_tangent(pdeg), 12);
        facts_significant(facts, "max_distortion", measure_secant(pdeg), 12);
    } else {
        facts_null(facts, "image_radius", why);
        facts_null(facts, "max_distortion", why);
    }
}

/// The indices in the scene's file; a centre that stands for a cluster has none, and is left out.
static void print_references(struct facts *facts, const char *name, const struct tree *tree,
                             const struct scene_aim_result *result, uint8_t count) {
    uint32_t source[4], known = 0;
    for (uint8_t i = 0; i < count; i++) {
        if ((result->reference[i] & SCENE_AIM_CENTER) == 0U) {
            const uint32_t index = tree->points[result->reference[i]].source;
            uint32_t at = known++;
            for (; at != 0U && source[at - 1U] > index; at--) {
                source[at] = source[at - 1U];
            }
            source[at] = index;
        }
    }
    facts_indices(facts, name, source, known, NULL, NULL);
}

static void print_aim(const struct settings *settings, const struct tree *tree, struct vec3 up,
                      bool feasible, const struct scene_aim_result *result) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "feasible", feasible);
    facts_u64(&facts, "count", count_points(tree));
    if (feasible) {
        const struct vec3 ahead = result->cone.axis_q30;
        const struct orient_axes axes = orient_axes(ahead, up);
        facts_text(&facts, "method", "tree");
        facts_vec3(&facts, "ahead_q30", ahead);
        facts_vec3(&facts, "right_q30", axes.right_q30);
        facts_vec3(&facts, "up_q30", axes.up_q30);
        facts_fixed(&facts, "pan_deg", measure_pan_deg(ahead), 12);
        facts_fixed(&facts, "tilt_deg", measure_tilt_deg(ahead), 12);
        print_half_angle(&facts, &result->cone);
        print_references(&facts, "support", tree, result, result->cone.support_count);
        facts_significant(&facts, "loss_px", result->loss_px_q8 / 256.0, 9);
        facts_u64(&facts, "nodes_opened", result->nodes_opened);
        facts_u64(&facts, "point_reads", result->point_reads);
    } else if (tree->header->node_count != 0U) {
        print_references(&facts, "witness", tree, result, result->cone.witness_count);
    }
    facts_end(&facts);
}

static enum exit_status aim(const struct command *command, const struct settings *settings,
                            const struct tree *tree, const char *file) {
    static const struct decimal origin[3];
    struct direction up = {.coarse = {0, 0, 1}};
    struct scene_aim_options aim_options = {.focal_px_q8 = 0};
    if (settings->up.given && !direction_from_decimals(settings->up.component, origin, &up)) {
        message_command(command->name, "--up: the zero vector has no direction");
        return EXIT_STATUS_USAGE;
    }
    if (settings->focal_px != NULL &&
        !read_px(command, "--focal-px", settings->focal_px, &aim_options.focal_px_q8)) {
        return EXIT_STATUS_USAGE;
    }
    if (!place_viewpoint(&settings->viewpoint, tree, &aim_options.eye)) {
        message_command(command->name, "--viewpoint is more than %g from the origin of this scene",
                        TREE_COORDINATE_MAX * unit_of(tree));
        return EXIT_STATUS_USAGE;
    }
    struct scene_aim_memory *const memory = malloc(sizeof *memory);
    if (memory == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    struct scene_aim_result result;
    const enum scene_aim_status status = scene_aim(tree, &aim_options, memory, &result);
    free(memory);
    switch (status) {
    case SCENE_AIM_OK:
        print_aim(settings, tree, up.coarse, true, &result);
        return EXIT_STATUS_OK;
    case SCENE_AIM_INFEASIBLE:
    case SCENE_AIM_EMPTY:
        print_aim(settings, tree, up.coarse, false, &result);
        return EXIT_STATUS_INFEASIBLE;
    case SCENE_AIM_AT_VIEWPOINT:
        message_at(file, 0, "a point is at the viewpoint: it has no direction");
        return EXIT_STATUS_USAGE;
    default:
        message_command(command->name, "internal failure %d", (int)status);
        return EXIT_STATUS_FAILURE;
    }
}

// ---------------------------------------------------------------- render

static void to_reals(const struct triple *triple, double out[3]) {
    for (int i = 0; i < 3 && triple->given; i++) {
        out[i] = (double)decimal_value(&triple->component[i]);
    }
}

/// WxH, each 16 to 16,384.
static bool read_size(const char *text, uint32_t *width, uint32_t *height) {
    unsigned w, h;
    int end = 0;
    if (sscanf(text, "%5ux%5u%n", &w, &h, &end) != 2 || text[end] != '\0' || w < 16U ||
        w > 16384U || h < 16U || h > 16384U) {
        return false;
    }
    *width = w;
    *height = h;
    return true;
}

static bool read_render(const struct command *command, const struct settings *settings,
                        struct scene_render_options *out) {
    *out = (struct scene_render_options){.up = {0, 0, 1},
                                         .aim_given = settings->aim.given,
                                         .fov_deg = 60,
                                         .width = 1280,
                                         .height = 720,
                                         .targets = settings->targets,
                                         .levine = settings->method == 1};
    to_reals(&settings->viewpoint, out->viewpoint);
    to_reals(&settings->aim, out->aim);
    to_reals(&settings->up, out->up);
    if (settings->output == NULL) {
        message_command(command->name, "render: -o FILE says where to write the picture");
        return false;
    }
    if (settings->fov != NULL &&
        (!option_positive(command->name, "--fov", settings->fov, &out->fov_deg) ||
         out->fov_deg < 0.001 || out->fov_deg > 170.0)) {
        message_command(command->name, "--fov needs an angle from 0.001 to 170 degrees");
        return false;
    }
    if (settings->size != NULL && !read_size(settings->size, &out->width, &out->height)) {
        message_command(command->name, "--size %s: needs WxH in pixels, each from 16 to 16384",
                        message_quoted(settings->size, strlen(settings->size)).text);
        return false;
    }
    if (out->up[0] == 0 && out->up[1] == 0 && out->up[2] == 0) {
        message_command(command->name, "--up: the zero vector has no direction");
        return false;
    }
    return true;
}

static void print_render(const struct settings *settings,
                         const struct scene_render_result *result) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_u64(&facts, "objects", result->objects);
    facts_u64(&facts, "edges", result->edges);
    facts_u64(&facts, "segments", result->segments);
    facts_u64(&facts, "targets", result->targets);
    facts_u64(&facts, "targets_seen", result->targets_seen);
    if (result->cone) {
        facts_reals(&facts, "cone_axis", result->cone_axis, 3);
        facts_fixed(&facts, "half_angle_deg", result->cone_half_angle_deg, 9);
    } else {
        facts_null(&facts, "half_angle_deg", "no picture holds the targets in sight");
    }
    facts_u64(&facts, "memory_bytes", result->memory_bytes);
    facts_end(&facts);
}

/// Opens a tree, or reads a scene as text and makes one. out->block: to be freed, or NULL if
/// out is mapped.
static enum exit_status open_any(const char *path, struct scene_file *out, void **block) {
    char magic[4] = "";
    FILE *const stream = strcmp(path, "-") == 0 ? NULL : fopen(path, "rb");
    *block = NULL;
    *out = (struct scene_file){.block = NULL};
    if (stream != NULL) {
        const bool is_tree =
            fread(magic, 1, sizeof magic, stream) == sizeof magic && memcmp(magic, "COCA", 4) == 0;
        (void)fclose(stream);
        if (is_tree) {
            return scene_file_open(path, out);
        }
    }
    struct scene_text scene;
    enum exit_status status = scene_text_read(path, true, &scene);
    size_t size = 0, fault;
    if (status == EXIT_STATUS_OK &&
        (scene_build(&scene, &scene_build_default, block, &size) != SCENE_BUILD_OK ||
         tree_open(*block, size, &out->tree, &fault) != TREE_OK)) {
        message_at(path, 0, "this scene has no tree: too large or too deep");
        status = EXIT_STATUS_FAILURE;
    }
    scene_text_free(&scene);
    return status;
}

static enum exit_status render(const struct command *command, const struct settings *settings,
                               const char *path) {
    struct scene_render_options render_options;
    struct scene_render_result result;
    struct scene_file file;
    struct drawing drawing = {.width = 0};
    void *block;
    if (!read_render(command, settings, &render_options)) {
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = open_any(path, &file, &block);
    if (status == EXIT_STATUS_OK) {
        status = scene_render(&file.tree, path, &render_options, &drawing, &result);
    }
    if (status == EXIT_STATUS_OK) {
        status = drawing_write(&drawing, settings->output);
    }
    if (status == EXIT_STATUS_OK) {
        print_render(settings, &result);
    }
    drawing_free(&drawing);
    free(block);
    scene_file_close(&file);
    return status;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *operand[2] = {NULL, NULL};
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      operand, 2, &operands)) {
        return EXIT_STATUS_USAGE;
    }
    const char *const verb = operands != 0U ? operand[0] : "";
    if (strcmp(verb, "build") == 0) {
        return build(command, &settings, operand[1]);
    }
    if (strcmp(verb, "render") == 0 && operands == 2U) {
        return render(command, &settings, operand[1]);
    }
    if (strcmp(verb, "info") != 0 && strcmp(verb, "aim") != 0 && strcmp(verb, "render") != 0) {
        message_command(command->name, "needs `build`, `info`, `aim` or `render` first");
        return EXIT_STATUS_USAGE;
    }
    if (operands != 2U) {
        message_command(command->name, "%s: needs a tree, FILE.coca", verb);
        return EXIT_STATUS_USAGE;
    }
    struct scene_file file;
    enum exit_status status = scene_file_open(operand[1], &file);
    if (status == EXIT_STATUS_OK) {
        status = strcmp(verb, "info") == 0 ? info(&settings, &file.tree)
                                           : aim(command, &settings, &file.tree, operand[1]);
    }
    scene_file_close(&file);
    return status;
}

const struct command command_scene = {
    .name = "scene",
    .summary = "a sphere tree of many points: build it, aim at what it holds, draw it",
    .operands = "build FILE.scene -o FILE.coca | info FILE.coca | aim FILE.coca | render FILE",
    .help =
        "build reads a scene as text, Wavefront OBJ with clusters and details:\n"
        "  v X Y Z               a vertex\n"
        "  o NAME, g NAME        an object begins; its points are the vertices that its elements\n"
        "                        name, or those that stand in it if there are no elements\n"
        "  f, l, p I J ...       elements: vertices counted from 1, or backwards from -1\n"
        "  group NAME ... end    a cluster of objects; may be nested\n"
        "  detail MIN_RADIUS_PX  a description of the object, the coarsest first; taken from that\n"
        "                        projected radius on\n"
        "  detail within DIST    the same, taken while the viewer is that near\n"
        "and writes it as a tree of spheres. Clusters are kept, the rest is clustered. Faces that\n"
        "close up are a solid, which has to be convex; every face has to be planar.\n"
        "info tells what a tree holds.\n"
        "aim finds the narrowest cone of all points of the finest descriptions, as `boresight "
        "aim`\n"
        "does, and reads only points that can matter. With --focal-px clusters that a camera with\n"
        "that focal length would not resolve are taken as their centre.\n\n"
        "render draws a scene (text or tree) without its hidden lines, as SVG or PNG: solids, "
        "faces\n"
        "and lines; points are targets, full where they are in sight; with the narrowest cone of\n"
        "those in sight and the frame of the picture. No two solids may overlap.\n\n"
        "results of aim, besides those of `boresight aim`:\n"
        "  loss_px               no point is farther outside the cone than that\n"
        "  nodes_opened          spheres whose contents were looked at\n"
        "  point_reads           reads of a point\n"
        "results of render:\n"
        "  edges, segments       edges not at the back of their solid; their visible parts\n"
        "  targets_seen          targets that nothing hides\n"
        "  memory_bytes          what finding the hidden lines took\n"
        "Indices count the vertices from 0.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run,
};

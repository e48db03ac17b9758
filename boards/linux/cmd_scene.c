/// `boresight scene`: build a sphere tree from a scene, tell about it, aim at what it holds, draw
/// it, and count what drawing it takes.
#include "facts.h"
#include "scene_command.h"
#include "scene_file.h"
#include "scene_render.h"
#include "scene_tree.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const render_methods[] = {"clip", "levine", NULL};

static const struct option options[] = {
    {"-o", "FILE", "build: where to write the tree; render: the picture, .svg or .png", option_text,
     offsetof(struct scene_settings, output), NULL},
    {"--coarse-px", "PX", "build: clusters below that radius are their centre (0.5; 0: never)",
     option_text, offsetof(struct scene_settings, coarse_px), NULL},
    {"--points", NULL, "build: only points; leave faces and lines out", option_flag,
     offsetof(struct scene_settings, points), NULL},
    {"--viewpoint", "X,Y,Z", "aim, render: where the viewer is (0,0,0)", option_triple,
     offsetof(struct scene_settings, viewpoint), NULL},
    {"--up", "X,Y,Z", "aim, render: what shall be up in the picture (0,0,1)", option_triple,
     offsetof(struct scene_settings, up), NULL},
    {"--changes", "FILE",
     "aim: objects that have moved, gone or come: away, back, move, copy, point", option_text,
     offsetof(struct scene_settings, changes), NULL},
    {"--focal-px", "PX", "aim: at the resolution of a camera with that focal length", option_text,
     offsetof(struct scene_settings, focal_px), NULL},
    {"--aim", "X,Y,Z", "render: the place to look at (the targets in sight)", option_triple,
     offsetof(struct scene_settings, aim), NULL},
    {"--fov", "DEG", "render: the angle of the picture's width (60)", option_text,
     offsetof(struct scene_settings, fov), NULL},
    {"--size", "WxH", "render: of the picture in pixels (1280x720)", option_text,
     offsetof(struct scene_settings, size), NULL},
    {"--targets", "FILE", "render: places to aim at, besides the scene's points", option_text,
     offsetof(struct scene_settings, targets), NULL},
    {"--method", "clip|levine", "render: how hidden lines are found (clip)", option_choice,
     offsetof(struct scene_settings, method), render_methods},
    {"--distance", "RADII", "measure: of the eye from the scene's middle (1.25)", option_text,
     offsetof(struct scene_settings, distance), NULL},
    OPTION_JSON(struct scene_settings),
};

static enum exit_status build(const struct command *command, const struct scene_settings *settings,
                              const char *file) {
    struct scene_build_options build_options = scene_build_default;
    if (settings->output == NULL) {
        message_command(command->name, "build: -o FILE says where to write the tree");
        return EXIT_STATUS_USAGE;
    }
    if (settings->coarse_px != NULL &&
        !scene_command_px(command, "--coarse-px", settings->coarse_px,
                          &build_options.coarse_px_q8)) {
        return EXIT_STATUS_USAGE;
    }
    struct scene_tree scene;
    enum exit_status status = scene_tree_read(file, !settings->points, &build_options, &scene);
    if (status == EXIT_STATUS_OK) {
        status = scene_tree_check(&scene, file);
    }
    if (status == EXIT_STATUS_OK) {
        status = scene_file_write(settings->output, scene.block, scene.size_bytes);
    }
    scene_tree_free(&scene);
    return status;
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

static enum exit_status info(const struct scene_settings *settings, const struct tree *tree) {
    const struct tree_header *const h = tree->header;
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_u64(&facts, "bytes", h->size_bytes);
    facts_u64(&facts, "nodes", h->node_count);
    facts_u64(&facts, "descriptions", h->description_count);
    facts_u64(&facts, "points", h->point_count);
    facts_u64(&facts, "levels", h->level_count);
    print_shapes(&facts, tree);
    facts_significant(&facts, "unit", scene_command_unit(tree), 17);
    if (h->node_count != 0U) {
        const struct tree_node *const root = &tree->nodes[0];
        facts_significant(&facts, "center_x", root->x * scene_command_unit(tree), 12);
        facts_significant(&facts, "center_y", root->y * scene_command_unit(tree), 12);
        facts_significant(&facts, "center_z", root->z * scene_command_unit(tree), 12);
        facts_significant(&facts, "radius", root->radius * scene_command_unit(tree), 12);
    }
    facts_end(&facts);
    return EXIT_STATUS_OK;
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

static bool read_render(const struct command *command, const struct scene_settings *settings,
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

static void print_render(const struct scene_settings *settings,
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
    struct scene_tree scene;
    const enum exit_status status = scene_tree_read(path, true, &scene_build_default, &scene);
    *block = scene.block;
    out->tree = scene.tree;
    return status;
}

static enum exit_status render(const struct command *command, const struct scene_settings *settings,
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

static enum exit_status measure(const struct command *command,
                                const struct scene_settings *settings, const char *path) {
    struct scene_file file;
    void *block;
    enum exit_status status = open_any(path, &file, &block);
    if (status == EXIT_STATUS_OK) {
        status = scene_command_measure(command, settings, &file.tree, path);
    }
    free(block);
    scene_file_close(&file);
    return status;
}

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct scene_settings settings = {0};
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
    if (strcmp(verb, "measure") == 0 && operands == 2U) {
        return measure(command, &settings, operand[1]);
    }
    const bool draws = strcmp(verb, "render") == 0 || strcmp(verb, "measure") == 0;
    if (strcmp(verb, "info") != 0 && strcmp(verb, "aim") != 0 && !draws) {
        message_command(command->name, "needs `build`, `info`, `aim`, `render` or `measure` first");
        return EXIT_STATUS_USAGE;
    }
    if (operands != 2U) {
        message_command(command->name, "%s: needs a %s", verb,
                        draws ? "scene, FILE.scene or FILE.coca" : "tree, FILE.coca");
        return EXIT_STATUS_USAGE;
    }
    struct scene_file file;
    enum exit_status status = scene_file_open(operand[1], &file);
    if (status == EXIT_STATUS_OK) {
        status = strcmp(verb, "info") == 0
                     ? info(&settings, &file.tree)
                     : scene_command_aim(command, &settings, &file.tree, operand[1]);
    }
    scene_file_close(&file);
    return status;
}

const struct command command_scene = {
    .name = "scene",
    .summary = "a sphere tree of many points: build it, aim at what it holds, draw it",
    .operands = "build FILE.scene -o FILE.coca | info FILE.coca | aim FILE.coca | render FILE |\n"
                "       measure FILE",
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
        "--changes reads changes, one a line, in the scene's unit:\n"
        "  away NAME, back NAME  the object is not in its place; it is again\n"
        "  move X Y Z NAME       it is so far from there\n"
        "  copy X Y Z NAME       one more of it, so far from there\n"
        "  point X Y Z           one more point\n\n"
        "render draws a scene (text or tree) without its hidden lines, as SVG or PNG: solids, "
        "faces\n"
        "and lines; points are targets, full where they are in sight; with the narrowest cone of\n"
        "those in sight and the frame of the picture. No two solids may overlap.\n\n"
        "measure counts what the pipeline of Levine's thesis does, in two turns of 360 views: the\n"
        "eye goes around the middle and looks at it, on a level circle (yaw, from the south, as "
        "pan\n"
        "counts) and on the upright one (pitch). Each view is a line of 12 counters, as appendix "
        "III\n"
        "calls them: faces in front; objects, windows, edges and crossings looked at for first\n"
        "vertices (/I); edges drawn; the same for them (/HL), and crossings there are; pairs that\n"
        "were clipped; and the visible segments. Each turn ends with its mean.\n\n"
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

/// `boresight scene aim`.
#include "facts.h"
#include "measure.h"
#include "scene_changes.h"
#include "scene_command.h"

#include "aim/orient.h"
#include "scene/scene_aim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool scene_command_px(const struct command *command, const char *name, const char *text,
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

double scene_command_unit(const struct tree *tree) {
    double unit;
    memcpy(&unit, tree->header->unit_double, sizeof unit);
    return unit;
}

/// The viewpoint in whole units of the tree, rounded. False: too far from the scene.
static bool place_viewpoint(const struct triple *viewpoint, const struct tree *tree,
                            struct vec3 *eye) {
    int32_t out[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && viewpoint->given; axis++) {
        const long double value =
            decimal_value(&viewpoint->component[axis]) / (long double)scene_command_unit(tree);
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
                             const struct scene_changes *changes,
                             const struct scene_aim_result *result, uint8_t count) {
    uint32_t source[4], known = 0;
    for (uint8_t i = 0; i < count; i++) {
        if ((result->reference[i] & SCENE_AIM_CENTER) == 0U) {
            const struct tree_point *const own =
                result->item[i] != OVERLAY_NONE ? changes->overlay.items[result->item[i]].points
                                                : NULL;
            const uint32_t index = (own != NULL ? own : tree->points)[result->reference[i]].source;
            uint32_t at = known++;
            for (; at != 0U && source[at - 1U] > index; at--) {
                source[at] = source[at - 1U];
            }
            source[at] = index;
        }
    }
    facts_indices(facts, name, source, known, NULL, NULL);
}

static void print_aim(const struct scene_settings *settings, const struct tree *tree,
                      const struct scene_changes *changes, struct vec3 up, bool feasible,
                      const struct scene_aim_result *result) {
    struct facts facts;
    facts_begin(&facts, stdout, settings->json);
    facts_bool(&facts, "feasible", feasible);
    facts_u64(&facts, "count", changes->count);
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
        print_references(&facts, "support", tree, changes, result, result->cone.support_count);
        facts_significant(&facts, "loss_px", result->loss_px_q8 / 256.0, 9);
        facts_u64(&facts, "nodes_opened", result->nodes_opened);
        facts_u64(&facts, "point_reads", result->point_reads);
    } else if (changes->count != 0U) {
        print_references(&facts, "witness", tree, changes, result, result->cone.witness_count);
    }
    facts_end(&facts);
}

static enum exit_status tell_aim(const struct command *command,
                                 const struct scene_settings *settings, const struct tree *tree,
                                 const struct scene_changes *changes, struct vec3 up,
                                 const char *file, enum scene_aim_status status,
                                 const struct scene_aim_result *result) {
    switch (status) {
    case SCENE_AIM_OK:
        print_aim(settings, tree, changes, up, true, result);
        return EXIT_STATUS_OK;
    case SCENE_AIM_INFEASIBLE:
    case SCENE_AIM_EMPTY:
        print_aim(settings, tree, changes, up, false, result);
        return EXIT_STATUS_INFEASIBLE;
    case SCENE_AIM_AT_VIEWPOINT:
        message_at(file, 0, "a point is at the viewpoint: it has no direction");
        return EXIT_STATUS_USAGE;
    default:
        message_command(command->name, "internal failure %d", (int)status);
        return EXIT_STATUS_FAILURE;
    }
}

/// About 24 KB: not on the stack.
static struct scene_aim_memory memory;

enum exit_status scene_command_aim(const struct command *command,
                                   const struct scene_settings *settings, const struct tree *tree,
                                   const char *file) {
    static const struct decimal origin[3];
    struct direction up = {.coarse = {0, 0, 1}};
    struct scene_aim_options aim_options = {.focal_px_q8 = 0};
    if (settings->up.given && !direction_from_decimals(settings->up.component, origin, &up)) {
        message_command(command->name, "--up: the zero vector has no direction");
        return EXIT_STATUS_USAGE;
    }
    if (settings->focal_px != NULL &&
        !scene_command_px(command, "--focal-px", settings->focal_px, &aim_options.focal_px_q8)) {
        return EXIT_STATUS_USAGE;
    }
    if (!place_viewpoint(&settings->viewpoint, tree, &aim_options.eye)) {
        message_command(command->name, "--viewpoint is more than %g from the origin of this scene",
                        TREE_COORDINATE_MAX * scene_command_unit(tree));
        return EXIT_STATUS_USAGE;
    }
    struct scene_changes changes = {.count = count_points(tree)};
    if (settings->changes != NULL) {
        const enum exit_status read =
            scene_changes_read(settings->changes, tree, changes.count, &changes);
        if (read != EXIT_STATUS_OK) {
            scene_changes_free(&changes);
            return read;
        }
        aim_options.overlay = &changes.overlay;
    }
    struct scene_aim_result result;
    const enum scene_aim_status status = scene_aim(tree, &aim_options, &memory, &result);
    const enum exit_status ended =
        tell_aim(command, settings, tree, &changes, up.coarse, file, status, &result);
    scene_changes_free(&changes);
    return ended;
}

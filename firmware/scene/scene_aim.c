#include "scene/scene_aim.h"

#include "fixed/root.h"
#include "fixed/trig.h"
#include "scene/view.h"

/// 2^64 a turn. What the angles below can be wrong by: 2^-31 rad and some.
#define SLACK_TURN64 (UINT64_C(1) << 31)
/// Points that far inside the cone, 7 nrad, are taken into the set, too: the axis in Q1.30 is
/// rounded, and one of them may be farthest from the rounded one.
#define MARGIN_TURN64 (UINT64_C(1) << 35)
#define HALF_TURN64   (UINT64_C(1) << 63)

/// The set is never filled by points within the margin alone.
#define MARGIN_SET_MOST (SCENE_AIM_SET - 64U)
#define SEARCHES_MOST   1000U

struct aim {
    const struct tree *tree;
    const struct scene_aim_options *options;
    struct scene_aim_memory *memory;
    struct scene_aim_result *result;
    uint32_t set_count;
    uint32_t stack_count;
    struct vec3 axis_q30;
    // One search:
    uint64_t least_turn64; ///< what is nearer to the axis does not matter
    uint64_t cone_turn64;  ///< beyond this a point is outside
    uint64_t best_turn64;  ///< the farthest point outside so far
    uint32_t best;         ///< its reference
    struct vec3 best_direction;
};

static struct vec3 from_eye(const struct aim *aim, int32_t x, int32_t y, int32_t z) {
    const struct vec3 e = aim->options->eye;
    return vec3(x - e.x, y - e.y, z - e.z); // both below 2^30
}

/// Angle from the axis, 0 to half a turn; within SLACK_TURN64 / 4.
static uint64_t angle_of(struct vec3 axis_q30, struct vec3 d) {
    const struct vec3_i64 a = {axis_q30.x, axis_q30.y, axis_q30.z}, w = vec3_widen(d);
    // Components below 2^30 and 2^31: products below 2^61.
    const struct vec3_i64 n = {a.y * w.z - a.z * w.y, a.z * w.x - a.x * w.z, a.x * w.y - a.y * w.x};
    const int64_t along = a.x * w.x + a.y * w.y + a.z * w.z;
    const uint64_t acute = trig_atan2_turn64(vec3_i64_length(n), u64_abs(along));
    return along >= 0 ? acute : HALF_TURN64 - acute;
}

/// Half the angle that a sphere covers, rounded up; half a turn if the eye is in it.
static uint64_t covered_by(struct vec3 d, uint32_t radius) {
    const uint64_t distance2 = vec3_norm2(d), radius2 = (uint64_t)radius * radius;
    if (distance2 <= radius2) {
        return HALF_TURN64;
    }
    const uint64_t rest = distance2 - radius2;
    // sqrt(rest) with 31 places behind the point.
    const uint64_t tangent = root_u128((struct u128){rest << 62, rest >> 2});
    return trig_atan2_turn64((uint64_t)radius << 31, tangent) + SLACK_TURN64 / 4U;
}

static uint64_t bound_of(const struct aim *aim, const struct tree_node *node) {
    const struct vec3 d = from_eye(aim, node->x, node->y, node->z);
    const uint64_t covered = covered_by(d, node->radius);
    const uint64_t bound =
        covered >= HALF_TURN64 ? HALF_TURN64 : angle_of(aim->axis_q30, d) + covered + SLACK_TURN64;
    return bound < HALF_TURN64 ? bound : HALF_TURN64;
}

static bool is_in_set(const struct aim *aim, uint32_t reference) {
    for (uint32_t i = 0; i < aim->set_count; i++) {
        if (aim->memory->reference[i] == reference) {
            return true;
        }
    }
    return false;
}

static void add_to_set(struct aim *aim, uint32_t reference, struct vec3 direction) {
    aim->memory->reference[aim->set_count] = reference;
    aim->memory->direction[aim->set_count++] = direction;
}

/// A point is read. False: it is at the viewpoint.
static bool meet(struct aim *aim, uint32_t reference, struct vec3 d) {
    aim->result->point_reads++;
    if (vec3_is_zero(d)) {
        aim->result->reference[0] = reference;
        return false;
    }
    const uint64_t angle = angle_of(aim->axis_q30, d);
    if (angle < aim->least_turn64) {
        return true;
    }
    if (angle > aim->cone_turn64 + SLACK_TURN64) {
        if (angle > aim->best_turn64) {
            aim->best_turn64 = angle;
            aim->best = reference;
            aim->best_direction = d;
            aim->least_turn64 = angle;
        }
    } else if (aim->set_count < MARGIN_SET_MOST && !is_in_set(aim, reference)) {
        add_to_set(aim, reference, d);
    }
    return true;
}

/// Puts nodes on the stack, of a few the one with the largest bound last, which comes off first.
static void push(struct aim *aim, uint32_t first, uint32_t count) {
    struct scene_aim_entry *const stack = aim->memory->stack;
    if (count > 8U || aim->stack_count + count >= SCENE_AIM_STACK) {
        stack[aim->stack_count++] = (struct scene_aim_entry){HALF_TURN64, first, first + count};
        return;
    }
    const uint32_t base = aim->stack_count;
    for (uint32_t i = first; i < first + count; i++) {
        const uint64_t bound = bound_of(aim, &aim->tree->nodes[i]);
        if (bound <= aim->least_turn64) {
            continue;
        }
        uint32_t at = aim->stack_count++;
        for (; at > base && stack[at - 1U].bound_turn64 > bound; at--) {
            stack[at] = stack[at - 1U];
        }
        stack[at] = (struct scene_aim_entry){bound, i, i + 1U};
    }
}

/// False: a point is at the viewpoint.
static bool open_node(struct aim *aim, uint32_t index) {
    const struct tree_node *const node = &aim->tree->nodes[index];
    uint32_t px_q8 = UINT32_MAX, distance = 0;
    if (aim->options->focal_px_q8 != 0U) {
        px_q8 = view_straight_px_q8(aim->options->focal_px_q8, aim->options->eye, tree_center(node),
                                    node->radius);
        distance = view_distance(aim->options->eye, tree_center(node));
    }
    const struct tree_description *const d = view_choose(aim->tree, node, px_q8, distance);
    aim->result->nodes_opened++;
    if (tree_kind(d) == TREE_NODES) {
        push(aim, d->first, d->count);
    } else if (tree_kind(d) == TREE_CENTER) {
        aim->result->loss_px_q8 = px_q8 > aim->result->loss_px_q8 ? px_q8 : aim->result->loss_px_q8;
        return meet(aim, index | SCENE_AIM_CENTER, from_eye(aim, node->x, node->y, node->z));
    }
    for (uint32_t i = d->first; tree_kind(d) == TREE_POINTS && i < d->first + d->count; i++) {
        const struct tree_point *const p = &aim->tree->points[i];
        if (!meet(aim, i, from_eye(aim, p->x, p->y, p->z))) {
            return false;
        }
    }
    return true;
}

/// Looks for the farthest point outside the cone; takes in what is within the margin. False: a
/// point is at the viewpoint.
static bool search(struct aim *aim, uint64_t cone_turn64) {
    aim->cone_turn64 = cone_turn64;
    aim->least_turn64 = cone_turn64 > MARGIN_TURN64 ? cone_turn64 - MARGIN_TURN64 : 0U;
    aim->best_turn64 = 0;
    aim->best = UINT32_MAX;
    aim->stack_count = 0;
    aim->result->searches++;
    push(aim, 0, 1);
    while (aim->stack_count != 0U) {
        struct scene_aim_entry *const top = &aim->memory->stack[aim->stack_count - 1U];
        const uint32_t node = top->next++;
        const bool range = top->bound_turn64 == HALF_TURN64 && top->end > node + 1U;
        uint64_t bound = top->bound_turn64;
        if (!range) {
            aim->stack_count--;
        } else {
            bound = bound_of(aim, &aim->tree->nodes[node]);
        }
        if ((bound > aim->least_turn64 || bound == HALF_TURN64) && !open_node(aim, node)) {
            return false;
        }
    }
    return true;
}

/// A point outside enters; without room left, all but the support go.
static void enter(struct aim *aim) {
    if (aim->set_count == SCENE_AIM_SET) {
        const struct cone_result *const cone = &aim->result->cone;
        for (uint32_t i = 0; i < cone->support_count; i++) { // ascending: never onto a later one
            aim->memory->reference[i] = aim->memory->reference[cone->support[i]];
            aim->memory->direction[i] = aim->memory->direction[cone->support[i]];
        }
        aim->set_count = cone->support_count;
    }
    add_to_set(aim, aim->best, aim->best_direction);
}

static enum cone_status solve(struct aim *aim) {
    const struct cone_options options = {.lengths = CONE_LENGTHS_ANY,
                                         .workspace = aim->memory->cone,
                                         .workspace_bytes = sizeof aim->memory->cone};
    const enum cone_status status =
        cone_narrowest(aim->memory->direction, aim->set_count, &options, &aim->result->cone);
    aim->result->point_reads += aim->result->cone.point_reads;
    return status;
}

/// The set to begin with: what the caller knows, or the point farthest from the root's middle.
static bool begin(struct aim *aim) {
    for (uint32_t i = 0; i < aim->options->warm_count && i < 4U; i++) {
        const uint32_t reference = aim->options->warm[i], index = reference & ~SCENE_AIM_CENTER;
        struct vec3 d = vec3(0, 0, 0);
        if ((reference & SCENE_AIM_CENTER) != 0U) {
            // Only of use where centres stand for points.
            if (index < aim->tree->header->node_count && aim->options->focal_px_q8 != 0U) {
                const struct tree_node *const n = &aim->tree->nodes[index];
                d = from_eye(aim, n->x, n->y, n->z);
            }
        } else if (index < aim->tree->header->point_count) {
            const struct tree_point *const p = &aim->tree->points[index];
            d = from_eye(aim, p->x, p->y, p->z);
        }
        if (!vec3_is_zero(d) && !is_in_set(aim, reference)) {
            aim->result->point_reads++;
            add_to_set(aim, reference, d);
        }
    }
    const struct tree_node *const root = &aim->tree->nodes[0];
    aim->axis_q30 = vec3_normalise(from_eye(aim, root->x, root->y, root->z));
    if (vec3_is_zero(aim->axis_q30)) {
        aim->axis_q30 = vec3(0, Q30_ONE, 0);
    }
    if (aim->set_count != 0U) {
        if (aim->options->focal_px_q8 == 0U) {
            return true;
        }
        // The descriptions may be others now: the old points only tell where to look first.
        if (solve(aim) == CONE_OK) {
            aim->axis_q30 = aim->result->cone.axis_q30;
        }
        aim->set_count = 0;
    }
    aim->best = UINT32_MAX;
    if (!search(aim, 0)) {
        return false;
    }
    if (aim->best != UINT32_MAX) {
        enter(aim);
    }
    return true;
}

static bool is_near(int32_t value) {
    return value >= -TREE_COORDINATE_MAX && value <= TREE_COORDINATE_MAX;
}

/// References of the points that the cone's result names.
static void name_points(struct aim *aim, const uint32_t *index, uint8_t count) {
    for (uint8_t i = 0; i < count; i++) {
        aim->result->reference[i] = aim->memory->reference[index[i]];
    }
}

enum scene_aim_status scene_aim(const struct tree *tree, const struct scene_aim_options *options,
                                struct scene_aim_memory *memory, struct scene_aim_result *result) {
    *result = (struct scene_aim_result){0};
    if (!is_near(options->eye.x) || !is_near(options->eye.y) || !is_near(options->eye.z)) {
        return SCENE_AIM_ERROR_VIEWPOINT;
    }
    if (tree->header->node_count == 0U) {
        return SCENE_AIM_EMPTY;
    }
    struct aim aim = {.tree = tree, .options = options, .memory = memory, .result = result};
    if (!begin(&aim)) {
        return SCENE_AIM_AT_VIEWPOINT;
    }
    while (result->searches < SEARCHES_MOST) {
        const enum cone_status status = solve(&aim);
        if (status != CONE_OK) {
            name_points(&aim, result->cone.witness, result->cone.witness_count);
            return SCENE_AIM_INFEASIBLE;
        }
        const uint32_t before = aim.set_count;
        aim.axis_q30 = result->cone.axis_q30;
        if (!search(&aim, result->cone.half_angle_turn64)) {
            return SCENE_AIM_AT_VIEWPOINT;
        }
        if (aim.best != UINT32_MAX) {
            enter(&aim);
        } else if (aim.set_count == before) {
            name_points(&aim, result->cone.support, result->cone.support_count);
            return SCENE_AIM_OK;
        }
    }
    return SCENE_AIM_UNFINISHED;
}

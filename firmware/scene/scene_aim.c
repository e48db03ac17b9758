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

/// An entry of the stack: `next` is a node of the overlay.
#define OVERLAY_NODES (OVERLAY_NONE - 1U)

/// The set is never filled by points within the margin alone.
#define MARGIN_SET_MOST (SCENE_AIM_SET - 64U)
#define SEARCHES_MOST   1000U

enum phase {
    PHASE_FIRST, ///< the search for a point to begin with
    PHASE_SOLVE,
    PHASE_SEARCH,
    PHASE_REFUSED ///< the viewpoint is too far away
};

static struct vec3 from_eye(const struct scene_aim_run *aim, int32_t x, int32_t y, int32_t z) {
    const struct vec3 e = aim->options.eye;
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

static uint64_t bound_of(const struct scene_aim_run *aim, struct vec3 center, uint32_t radius) {
    const struct vec3 d = from_eye(aim, center.x, center.y, center.z);
    const uint64_t covered = covered_by(d, radius);
    const uint64_t bound =
        covered >= HALF_TURN64 ? HALF_TURN64 : angle_of(aim->axis_q30, d) + covered + SLACK_TURN64;
    return bound < HALF_TURN64 ? bound : HALF_TURN64;
}

/// How far the overlay moves an item's points.
static struct vec3 offset_of(const struct scene_aim_run *aim, uint32_t item) {
    return item == OVERLAY_NONE ? vec3(0, 0, 0) : aim->options.overlay->items[item].offset;
}

/// The description that a node deserves, and in *px_q8 how large it appears to a camera with a
/// resolution.
static const struct tree_description *chosen(const struct scene_aim_run *aim, uint32_t index,
                                             struct vec3 center, uint32_t *px_q8) {
    const struct tree_node *const node = &aim->tree->nodes[index];
    uint32_t distance = 0;
    *px_q8 = UINT32_MAX;
    if (aim->options.focal_px_q8 != 0U) {
        *px_q8 =
            view_straight_px_q8(aim->options.focal_px_q8, aim->options.eye, center, node->radius);
        distance = view_distance(aim->options.eye, center);
    }
    return view_choose(aim->tree, node, *px_q8, distance);
}

/// No point read below the node is farther from the axis. Where its centre stands for all of it,
/// that is the centre's own angle, and what is lost by it is noted.
static uint64_t bound_of_node(struct scene_aim_run *aim, uint32_t index, uint32_t item) {
    const struct tree_node *const node = &aim->tree->nodes[index];
    const struct vec3 center = overlay_place(tree_center(node), offset_of(aim, item));
    const uint64_t bound = bound_of(aim, center, node->radius);
    uint32_t px_q8;
    if (aim->options.focal_px_q8 == 0U || bound <= aim->least_turn64 ||
        tree_kind(chosen(aim, index, center, &px_q8)) != TREE_CENTER) {
        return bound;
    }
    aim->result->loss_px_q8 = px_q8 > aim->result->loss_px_q8 ? px_q8 : aim->result->loss_px_q8;
    return bound_of(aim, center, 0);
}

static bool is_in_set(const struct scene_aim_run *aim, uint32_t reference, uint32_t item) {
    for (uint32_t i = 0; i < aim->set_count; i++) {
        if (aim->memory->reference[i] == reference && aim->memory->item[i] == item) {
            return true;
        }
    }
    return false;
}

static void add_to_set(struct scene_aim_run *aim, uint32_t reference, uint32_t item,
                       struct vec3 direction) {
    aim->memory->reference[aim->set_count] = reference;
    aim->memory->item[aim->set_count] = item;
    aim->memory->direction[aim->set_count++] = direction;
}

/// A point is read. False: it is at the viewpoint.
static bool meet(struct scene_aim_run *aim, uint32_t reference, uint32_t item, struct vec3 d) {
    aim->result->point_reads++;
    if (vec3_is_zero(d)) {
        aim->result->reference[0] = reference;
        aim->result->item[0] = item;
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
            aim->best_item = item;
            aim->best_direction = d;
            aim->least_turn64 = angle;
        }
    } else if (aim->set_count < MARGIN_SET_MOST && !is_in_set(aim, reference, item)) {
        add_to_set(aim, reference, item, d);
    }
    return true;
}

/// Puts an entry on the stack, above `base` in the order of the bounds: the largest on top.
static void push_sorted(struct scene_aim_run *aim, uint32_t base, struct scene_aim_entry entry) {
    struct scene_aim_entry *const stack = aim->memory->stack;
    if (entry.bound_turn64 <= aim->least_turn64) {
        return;
    }
    uint32_t at = aim->stack_count++;
    for (; at > base && stack[at - 1U].bound_turn64 > entry.bound_turn64; at--) {
        stack[at] = stack[at - 1U];
    }
    stack[at] = entry;
}

/// An object in its place is left out if it is away from there.
static bool is_left_out(const struct scene_aim_run *aim, uint32_t node, uint32_t item) {
    return item == OVERLAY_NONE &&
           overlay_is_away(aim->options.overlay, aim->tree->nodes[node].part);
}

/// Puts nodes on the stack: a few sorted, many as one entry.
static void push(struct scene_aim_run *aim, uint32_t first, uint32_t count, uint32_t item) {
    struct scene_aim_entry *const stack = aim->memory->stack;
    if (count > 8U || aim->stack_count + count >= SCENE_AIM_STACK) {
        stack[aim->stack_count++] =
            (struct scene_aim_entry){HALF_TURN64, first, first + count, item};
        return;
    }
    const uint32_t base = aim->stack_count;
    for (uint32_t i = first; i < first + count; i++) {
        if (!is_left_out(aim, i, item)) {
            push_sorted(aim, base,
                        (struct scene_aim_entry){bound_of_node(aim, i, item), i, i + 1U, item});
        }
    }
}

static void push_overlay(struct scene_aim_run *aim, uint32_t base, uint32_t index) {
    const struct overlay_sphere *const s = &aim->options.overlay->nodes[index].sphere;
    push_sorted(aim, base,
                (struct scene_aim_entry){bound_of(aim, s->center, s->radius), index, index + 1U,
                                         OVERLAY_NODES});
}

/// False: a point is at the viewpoint.
static bool meet_points(struct scene_aim_run *aim, const struct tree_point *points, uint32_t first,
                        uint32_t count, uint32_t item) {
    const struct vec3 offset = offset_of(aim, item);
    for (uint32_t i = first; i < first + count; i++) {
        const struct vec3 p = overlay_place(vec3(points[i].x, points[i].y, points[i].z), offset);
        if (!meet(aim, i, item, from_eye(aim, p.x, p.y, p.z))) {
            return false;
        }
    }
    return true;
}

/// False: a point is at the viewpoint.
static bool open_overlay(struct scene_aim_run *aim, uint32_t index) {
    const struct overlay *const o = aim->options.overlay;
    const struct overlay_node *const node = &o->nodes[index];
    aim->result->nodes_opened++;
    if (node->child[0] != OVERLAY_NONE) {
        const uint32_t base = aim->stack_count;
        push_overlay(aim, base, node->child[0]);
        push_overlay(aim, base, node->child[1]);
        return true;
    }
    const struct overlay_item *const item = &o->items[node->child[1]];
    if (item->points != NULL) {
        return meet_points(aim, item->points, 0, item->part_or_count, node->child[1]);
    }
    push(aim, aim->tree->parts[item->part_or_count].node, 1, node->child[1]);
    return true;
}

/// False: a point is at the viewpoint.
static bool open_node(struct scene_aim_run *aim, uint32_t index, uint32_t item) {
    const struct tree_node *const node = &aim->tree->nodes[index];
    const struct vec3 center = overlay_place(tree_center(node), offset_of(aim, item));
    uint32_t px_q8;
    const struct tree_description *const d = chosen(aim, index, center, &px_q8);
    aim->result->nodes_opened++;
    switch (tree_kind(d)) {
    case TREE_NODES:
        push(aim, d->first, d->count, item);
        return true;
    case TREE_CENTER:
        return meet(aim, index | SCENE_AIM_CENTER, item,
                    from_eye(aim, center.x, center.y, center.z));
    default:
        return meet_points(aim, aim->tree->points, d->first, d->count, item);
    }
}

/// Begins to look for the farthest point outside the cone, and for those within the margin.
static void begin_search(struct scene_aim_run *aim, uint64_t cone_turn64) {
    aim->cone_turn64 = cone_turn64;
    aim->least_turn64 = cone_turn64 > MARGIN_TURN64 ? cone_turn64 - MARGIN_TURN64 : 0U;
    aim->best_turn64 = 0;
    aim->best = UINT32_MAX;
    aim->stack_count = 0;
    aim->result->searches++;
    if (aim->tree->header->node_count != 0U) {
        push(aim, 0, 1, OVERLAY_NONE);
    }
    if (overlay_root(aim->options.overlay) != OVERLAY_NONE) {
        push_overlay(aim, 0, overlay_root(aim->options.overlay));
    }
}

/// Looks at the node on top of the stack. False: a point is at the viewpoint.
static bool search_on(struct scene_aim_run *aim) {
    struct scene_aim_entry *const top = &aim->memory->stack[aim->stack_count - 1U];
    const uint32_t node = top->next++, item = top->item;
    uint64_t bound = top->bound_turn64;
    if (top->end == node + 1U) {
        aim->stack_count--;
    }
    if (bound == HALF_TURN64 && item != OVERLAY_NODES) { // of several nodes: this one's own
        bound = is_left_out(aim, node, item) ? 0U : bound_of_node(aim, node, item);
    }
    if (bound <= aim->least_turn64 && bound != HALF_TURN64) {
        return true;
    }
    return item == OVERLAY_NODES ? open_overlay(aim, node) : open_node(aim, node, item);
}

/// A point outside enters; without room left, all but the support go.
static void enter(struct scene_aim_run *aim) {
    if (aim->set_count == SCENE_AIM_SET) {
        const struct cone_result *const cone = &aim->result->cone;
        for (uint32_t i = 0; i < cone->support_count; i++) { // ascending: never onto a later one
            aim->memory->reference[i] = aim->memory->reference[cone->support[i]];
            aim->memory->item[i] = aim->memory->item[cone->support[i]];
            aim->memory->direction[i] = aim->memory->direction[cone->support[i]];
        }
        aim->set_count = cone->support_count;
    }
    add_to_set(aim, aim->best, aim->best_item, aim->best_direction);
}

static enum cone_status solve(struct scene_aim_run *aim) {
    const struct cone_options options = {.lengths = CONE_LENGTHS_ANY,
                                         .workspace = aim->memory->cone,
                                         .workspace_bytes = sizeof aim->memory->cone};
    const enum cone_status status =
        cone_narrowest(aim->memory->direction, aim->set_count, &options, &aim->result->cone);
    aim->result->point_reads += aim->result->cone.point_reads;
    return status;
}

/// Takes the points that the caller knows into the set. Everything is in its place.
static void take_warm(struct scene_aim_run *aim) {
    for (uint32_t i = 0; i < aim->options.warm_count && i < 4U; i++) {
        const uint32_t reference = aim->options.warm[i], index = reference & ~SCENE_AIM_CENTER;
        struct vec3 d = vec3(0, 0, 0);
        if ((reference & SCENE_AIM_CENTER) != 0U) {
            // Only of use where centres stand for points.
            if (index < aim->tree->header->node_count && aim->options.focal_px_q8 != 0U) {
                const struct tree_node *const n = &aim->tree->nodes[index];
                d = from_eye(aim, n->x, n->y, n->z);
            }
        } else if (index < aim->tree->header->point_count) {
            const struct tree_point *const p = &aim->tree->points[index];
            d = from_eye(aim, p->x, p->y, p->z);
        }
        if (!vec3_is_zero(d) && !is_in_set(aim, reference, OVERLAY_NONE)) {
            aim->result->point_reads++;
            add_to_set(aim, reference, OVERLAY_NONE, d);
        }
    }
}

/// The axis to begin with: toward the middle of everything.
static void look_at_all(struct scene_aim_run *aim) {
    const uint32_t items = overlay_root(aim->options.overlay);
    struct vec3 middle = aim->options.eye;
    if (aim->tree->header->node_count != 0U) {
        middle = tree_center(&aim->tree->nodes[0]);
    } else if (items != OVERLAY_NONE) {
        middle = aim->options.overlay->nodes[items].sphere.center;
    }
    aim->axis_q30 = vec3_normalise(from_eye(aim, middle.x, middle.y, middle.z));
    if (vec3_is_zero(aim->axis_q30)) {
        aim->axis_q30 = vec3(0, Q30_ONE, 0);
    }
}

/// The set to begin with: what the caller knows, or the point farthest from some axis.
static void begin(struct scene_aim_run *aim) {
    look_at_all(aim);
    if (aim->options.overlay != NULL) {
        const struct vec3 toward = vec3_normalise(aim->options.toward_q30);
        aim->axis_q30 = vec3_is_zero(toward) ? aim->axis_q30 : toward;
    } else {
        take_warm(aim);
    }
    aim->phase = PHASE_FIRST;
    if (aim->set_count != 0U && aim->options.focal_px_q8 == 0U) {
        aim->phase = PHASE_SOLVE;
        return;
    }
    // The descriptions may be others now: the old points only tell where to look first.
    if (aim->set_count != 0U && solve(aim) == CONE_OK) {
        aim->axis_q30 = aim->result->cone.axis_q30;
    }
    aim->set_count = 0;
    begin_search(aim, 0);
}

static bool is_near(int32_t value) {
    return value >= -TREE_COORDINATE_MAX && value <= TREE_COORDINATE_MAX;
}

/// References of the points that the cone's result names.
static void name_points(struct scene_aim_run *aim, const uint32_t *index, uint8_t count) {
    for (uint8_t i = 0; i < count; i++) {
        aim->result->reference[i] = aim->memory->reference[index[i]];
        aim->result->item[i] = aim->memory->item[index[i]];
    }
}

/// The set's cone, and the search for what is outside.
static enum scene_aim_status solve_next(struct scene_aim_run *aim) {
    struct scene_aim_result *const result = aim->result;
    if (aim->set_count == 0U) {
        return SCENE_AIM_EMPTY;
    }
    if (result->searches >= SEARCHES_MOST) {
        return SCENE_AIM_UNFINISHED;
    }
    if (solve(aim) != CONE_OK) {
        name_points(aim, result->cone.witness, result->cone.witness_count);
        return SCENE_AIM_INFEASIBLE;
    }
    aim->set_before = aim->set_count;
    aim->axis_q30 = result->cone.axis_q30;
    aim->phase = PHASE_SEARCH;
    begin_search(aim, result->cone.half_angle_turn64);
    return SCENE_AIM_MORE;
}

/// A search is over. Nothing found, and nothing new within the margin: that is the cone.
static enum scene_aim_status end_search(struct scene_aim_run *aim) {
    if (aim->best != UINT32_MAX) {
        enter(aim);
    } else if (aim->phase == PHASE_SEARCH && aim->set_count == aim->set_before) {
        name_points(aim, aim->result->cone.support, aim->result->cone.support_count);
        return SCENE_AIM_OK;
    }
    aim->phase = PHASE_SOLVE;
    return SCENE_AIM_MORE;
}

void scene_aim_start(struct scene_aim_run *aim, const struct tree *tree,
                     const struct scene_aim_options *options, struct scene_aim_memory *memory,
                     struct scene_aim_result *result) {
    *result = (struct scene_aim_result){0};
    *aim = (struct scene_aim_run){.tree = tree,
                                  .options = *options,
                                  .memory = memory,
                                  .result = result,
                                  .phase = PHASE_REFUSED};
    if (is_near(options->eye.x) && is_near(options->eye.y) && is_near(options->eye.z)) {
        begin(aim);
    }
}

enum scene_aim_status scene_aim_go(struct scene_aim_run *aim, uint32_t steps) {
    enum scene_aim_status status = SCENE_AIM_MORE;
    if (aim->phase == PHASE_REFUSED) {
        return SCENE_AIM_ERROR_VIEWPOINT;
    }
    for (uint32_t i = 0; i < steps && status == SCENE_AIM_MORE; i++) {
        if (aim->phase == PHASE_SOLVE) {
            status = solve_next(aim);
        } else if (aim->stack_count != 0U) {
            status = search_on(aim) ? SCENE_AIM_MORE : SCENE_AIM_AT_VIEWPOINT;
        } else {
            status = end_search(aim);
        }
    }
    return status;
}

enum scene_aim_status scene_aim(const struct tree *tree, const struct scene_aim_options *options,
                                struct scene_aim_memory *memory, struct scene_aim_result *result) {
    struct scene_aim_run run;
    enum scene_aim_status status = SCENE_AIM_MORE;
    scene_aim_start(&run, tree, options, memory, result);
    while (status == SCENE_AIM_MORE) { // SEARCHES_MOST bounds it
        status = scene_aim_go(&run, UINT32_MAX);
    }
    return status;
}

/// An overlay after many random changes against the same scene built anew: what aiming finds, bit
/// for bit, and what of it a camera has in its picture; and the overlay's own order at every
/// look. SEED=N, CHANGES=N a scene (1,000,000 in `make check`).
#include "check.h"
#include "property/support/scene_sets.h"
#include "property/support/solid_check.h"

#include "scene/scene_aim.h"
#include "scene/walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ITEMS = 150, POINTS_MOST = 40000, OWN = 12 };

static uint64_t seed;
static unsigned long change_count = 1000000UL;
static const unsigned long look_count = 120UL; ///< comparisons
static struct scene_aim_memory memory;

/// What should be there.
struct model {
    struct tree tree;
    struct overlay overlay;
    uint32_t object_count;
    uint32_t *objects; ///< parts with a name
    bool *away;        ///< by part
    struct {
        bool used;
        uint32_t part; ///< OVERLAY_NONE: its own points
        struct vec3 offset;
    } item[ITEMS];
    uint32_t used;
    bool few; ///< no items: so that each object counts
    struct tree_point own[ITEMS][OWN];
    uint32_t own_count[ITEMS];
};

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int32_t within(int32_t size) {
    return (int32_t)solid_below(&seed, 2U * (uint32_t)size + 1U) - size;
}

static struct vec3 somewhere(int32_t size) {
    struct vec3 p;
    p.x = within(size);
    p.y = within(size);
    p.z = within(size);
    return p;
}

/// The finest points below a node, moved.
static uint32_t gather(const struct tree *tree, uint32_t node, struct vec3 offset,
                       struct vec3 *out) {
    const struct tree_description *const d =
        &tree->descriptions[tree->nodes[node].first_description +
                            tree->nodes[node].description_count - 1U];
    uint32_t count = 0;
    for (uint32_t i = d->first; i < d->first + d->count; i++) {
        if (tree_kind(d) == TREE_NODES) {
            count += gather(tree, i, offset, out + count);
        } else {
            const struct tree_point *const p = &tree->points[i];
            out[count++] = vec3(p->x + offset.x, p->y + offset.y, p->z + offset.z);
        }
    }
    return count;
}

static uint32_t gather_all(const struct model *m, struct vec3 *out) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < m->object_count; i++) {
        if (!m->away[m->objects[i]]) {
            count +=
                gather(&m->tree, m->tree.parts[m->objects[i]].node, vec3(0, 0, 0), out + count);
        }
    }
    for (uint32_t i = 0; i < ITEMS; i++) {
        const struct vec3 by = m->item[i].offset;
        if (m->item[i].used && m->item[i].part != OVERLAY_NONE) {
            count += gather(&m->tree, m->tree.parts[m->item[i].part].node, by, out + count);
        }
        for (uint32_t k = 0;
             m->item[i].used && m->item[i].part == OVERLAY_NONE && k < m->own_count[i]; k++) {
            const struct tree_point *const p = &m->own[i][k];
            out[count++] = vec3(p->x + by.x, p->y + by.y, p->z + by.z);
        }
    }
    return count;
}

static void add_item(struct model *m) {
    uint32_t item = OVERLAY_NONE;
    const struct vec3 offset = somewhere(1 << 26);
    const bool own = solid_below(&seed, 4) == 0U;
    const uint32_t part = own ? OVERLAY_NONE : m->objects[solid_below(&seed, m->object_count)];
    enum overlay_status status;
    struct tree_point points[OWN];
    uint32_t count = 0;
    if (own) {
        count = 1U + solid_below(&seed, OWN);
        for (uint32_t k = 0; k < count; k++) {
            const struct vec3 p = somewhere(1 << 20);
            points[k] = (struct tree_point){p.x, p.y, p.z, k};
        }
        // Which item it will be is not known yet: the free one that the overlay takes next.
        const uint32_t next = m->overlay.free_item != OVERLAY_NONE ? m->overlay.free_item : 0U;
        if (m->used < ITEMS) {
            memcpy(m->own[next], points, sizeof points);
            m->own_count[next] = count;
        }
        status = overlay_add_points(&m->overlay, m->own[next], count, offset, &item);
        CHECK(status != OVERLAY_OK || item == next);
    } else {
        status = overlay_add_object(&m->overlay, part, offset, &item);
    }
    CHECK_EQ(status, m->used < ITEMS ? OVERLAY_OK : OVERLAY_ERROR_CAPACITY);
    if (status == OVERLAY_OK && CHECK(item < ITEMS && !m->item[item].used)) {
        m->item[item].used = true;
        m->item[item].part = part;
        m->item[item].offset = offset;
        m->used++;
    }
}

static void change(struct model *m) {
    const uint32_t what = solid_below(&seed, 100);
    const uint32_t item = solid_below(&seed, ITEMS);
    if (what < 30U) {
        const uint32_t part = m->objects[solid_below(&seed, m->object_count)];
        // Mostly away: so that whole clusters become empty.
        m->away[part] = solid_below(&seed, 8) != 0U;
        CHECK_EQ(overlay_set_away(&m->overlay, part, m->away[part]), OVERLAY_OK);
    } else if (what < 45U) {
        if (!m->few) {
            add_item(m);
        }
    } else if (what < 60U) {
        CHECK_EQ(overlay_remove(&m->overlay, item),
                 m->item[item].used ? OVERLAY_OK : OVERLAY_ERROR_OBJECT);
        m->used -= m->item[item].used ? 1U : 0U;
        m->item[item].used = false;
    } else {
        // Small steps, as of something that walks, and now and then a leap.
        const struct vec3 step = somewhere(what < 95U ? 1 << 18 : 1 << 26);
        struct vec3 to = vec3(m->item[item].offset.x + step.x, m->item[item].offset.y + step.y,
                              m->item[item].offset.z + step.z);
        if (what >= 95U || abs(to.x) > 1 << 27 || abs(to.y) > 1 << 27 || abs(to.z) > 1 << 27) {
            to = step;
        }
        CHECK_EQ(overlay_move(&m->overlay, item, to),
                 m->item[item].used ? OVERLAY_OK : OVERLAY_ERROR_OBJECT);
        if (m->item[item].used) {
            m->item[item].offset = to;
        }
    }
}

static double apart(struct vec3 a, struct vec3 b) {
    return sqrt(((double)a.x - b.x) * ((double)a.x - b.x) +
                ((double)a.y - b.y) * ((double)a.y - b.y) +
                ((double)a.z - b.z) * ((double)a.z - b.z));
}

static uint32_t height_checked(const struct overlay *o, uint32_t at, uint32_t parent,
                               uint32_t *leaves) {
    const struct overlay_node *const node = &o->nodes[at];
    CHECK_EQ(node->parent, parent);
    if (node->child[0] == OVERLAY_NONE) {
        CHECK_EQ(o->items[node->child[1]].leaf, at);
        CHECK_EQ(node->height, 0U);
        (*leaves)++;
        return 0;
    }
    uint32_t height[2];
    for (unsigned i = 0; i < 2U && check_clean(); i++) {
        const struct overlay_node *const child = &o->nodes[node->child[i]];
        height[i] = height_checked(o, node->child[i], at, leaves);
        CHECK(apart(node->sphere.center, child->sphere.center) + child->sphere.radius <=
              node->sphere.radius + 1e-3);
    }
    if (!check_clean()) {
        return 0;
    }
    const uint32_t high = height[0] > height[1] ? height[0] : height[1];
    CHECK(2U * high - height[0] - height[1] <= 1U);
    CHECK_EQ(node->height, high + 1U);
    return high + 1U;
}

static void in_order(const struct model *m) {
    uint32_t leaves = 0;
    if (m->overlay.root != OVERLAY_NONE) {
        const uint32_t height = height_checked(&m->overlay, m->overlay.root, OVERLAY_NONE, &leaves);
        CHECK(height < OVERLAY_LEVELS_MAX);
    }
    CHECK(leaves == m->used && m->overlay.item_count == m->used);
    // A cluster is away exactly if no object below it is in its place.
    const uint32_t parts = m->tree.header->part_count;
    bool *const any = calloc(parts, sizeof *any);
    for (uint32_t i = parts; i-- != 0U;) {
        const struct tree_part *const part = &m->tree.parts[i];
        any[i] = any[i] || (part->name != TREE_NONE && !m->away[i]);
        if (any[i] && part->parent != TREE_NONE) {
            any[part->parent] = true;
        }
        CHECK_EQ(overlay_is_away(&m->overlay, i), !any[i]);
    }
    free(any);
}

static struct tree build_anew(struct vec3 *points, uint32_t count, void **block) {
    struct scene_detail detail = {.count = count};
    struct scene_object object = {-1, 0, 1, 0, SCENE_NONE};
    uint32_t *const list = malloc(count * sizeof *list);
    for (uint32_t i = 0; i < count; i++) {
        list[i] = i;
    }
    const struct scene_text scene = {
        .vertices = {.directions = points, .count = count, .unit = 1.0L},
        .objects = &object,
        .details = &detail,
        .points = list,
        .object_count = 1,
        .detail_count = 1,
        .point_count = count};
    struct scene_build_options options = scene_build_default;
    options.coarse_px_q8 = 0;
    struct tree tree;
    scene_set_open(&scene, &options, block, &tree);
    free(list);
    return tree;
}

static uint64_t reads_over, reads_anew, opened_over, opened_anew;

static void aims_are_equal(const struct model *m, const struct tree *anew, struct vec3 eye,
                           const struct vec3 *points, uint32_t count) {
    static struct vec3 directions[POINTS_MOST];
    for (uint32_t i = 0; i < count; i++) {
        directions[i] = vec3(points[i].x - eye.x, points[i].y - eye.y, points[i].z - eye.z);
    }
    void *const workspace = malloc(CONE_WORKSPACE_BYTES(count));
    const struct cone_options flat_options = {.workspace = workspace,
                                              .workspace_bytes = CONE_WORKSPACE_BYTES(count)};
    struct cone_result flat;
    const enum cone_status wanted = cone_narrowest(directions, count, &flat_options, &flat);
    free(workspace);
    const enum scene_aim_status expected = wanted == CONE_OK ? SCENE_AIM_OK
                                           : wanted == CONE_ERROR_ZERO_VECTOR
                                               ? SCENE_AIM_AT_VIEWPOINT
                                           : wanted == CONE_EMPTY ? SCENE_AIM_EMPTY
                                                                  : SCENE_AIM_INFEASIBLE;
    struct scene_aim_options options = {.eye = eye, .overlay = &m->overlay};
    struct scene_aim_result over, other;
    CHECK_EQ(scene_aim(&m->tree, &options, &memory, &over), expected);
    if (expected != SCENE_AIM_OK) {
        return;
    }
    reads_over += over.point_reads;
    opened_over += over.nodes_opened;
    CHECK(vec3_equal(over.cone.axis_q30, flat.axis_q30));
    CHECK_EQ(over.cone.half_angle_turn64, flat.half_angle_turn64);
    // From where the last one looked; and what holds the cone is where it says.
    options.toward_q30 = over.cone.axis_q30;
    CHECK_EQ(scene_aim(&m->tree, &options, &memory, &other), SCENE_AIM_OK);
    CHECK(vec3_equal(other.cone.axis_q30, flat.axis_q30));
    for (uint8_t i = 0; i < over.cone.support_count; i++) {
        const bool placed = over.item[i] == OVERLAY_NONE;
        const struct overlay_item *const item = &m->overlay.items[placed ? 0U : over.item[i]];
        const struct tree_point *const p =
            &(placed || item->points == NULL ? m->tree.points : item->points)[over.reference[i]];
        const struct vec3 at =
            overlay_place(vec3(p->x, p->y, p->z), placed ? vec3(0, 0, 0) : item->offset);
        uint32_t k = 0;
        while (k < count && !vec3_equal(points[k], at)) {
            k++;
        }
        CHECK(k < count);
    }
    const struct scene_aim_options plain = {.eye = eye};
    CHECK_EQ(scene_aim(anew, &plain, &memory, &other), SCENE_AIM_OK);
    CHECK(vec3_equal(other.cone.axis_q30, flat.axis_q30));
    CHECK_EQ(other.cone.half_angle_turn64, flat.half_angle_turn64);
    reads_anew += other.point_reads;
    opened_anew += other.nodes_opened;
}

static int by_place(const void *a, const void *b) {
    const struct vec3 *const p = a, *const q = b;
    if (p->x != q->x) {
        return p->x < q->x ? -1 : 1;
    }
    if (p->y != q->y) {
        return p->y < q->y ? -1 : 1;
    }
    return p->z != q->z ? (p->z < q->z ? -1 : 1) : 0;
}

/// In the picture, and not within a hair of its border; the picture is square, 90 degrees wide.
static bool is_in_picture(const struct view *view, struct vec3 p) {
    const double d[3] = {(double)p.x - view->eye.x, (double)p.y - view->eye.y,
                         (double)p.z - view->eye.z};
    const struct vec3 *const axis[3] = {&view->ahead, &view->right, &view->up};
    double part[3];
    for (unsigned i = 0; i < 3U; i++) {
        part[i] = (axis[i]->x * d[0] + axis[i]->y * d[1] + axis[i]->z * d[2]) * 0x1p-30;
    }
    return part[0] > 0 && fmax(fabs(part[1]), fabs(part[2])) < part[0] * (1.0 - 1e-6);
}

/// What of a walk is in the picture, in order.
static uint32_t pictured(const struct tree *tree, const struct overlay *overlay,
                         const struct view *view, struct vec3 *out) {
    struct walk walk;
    struct walk_item item;
    uint32_t count = 0;
    walk_start(&walk, tree, overlay, view);
    while (walk_next(&walk, &item)) {
        for (uint32_t i = 0; i < item.point_count; i++) {
            const struct tree_point *const p = &item.points[i];
            const struct vec3 at = overlay_place(vec3(p->x, p->y, p->z), item.offset);
            CHECK(apart(at, item.center) <=
                  (item.node != NULL ? item.node->radius : 4.0 * (1 << 20)) + 1.0);
            if (is_in_picture(view, at) && CHECK(count < POINTS_MOST)) {
                out[count++] = at;
            }
        }
    }
    qsort(out, count, sizeof *out, by_place);
    return count;
}

static uint64_t pictured_in_all;

static void pictures_are_equal(const struct model *m, const struct tree *anew, struct vec3 eye,
                               struct vec3 *points, uint32_t count) {
    static struct vec3 over[POINTS_MOST], other[POINTS_MOST];
    struct vec3 ahead, side;
    do {
        ahead = vec3_normalise(somewhere(1000));
        side = vec3_normalise(somewhere(1000));
    } while (vec3_is_zero(ahead) || vec3_is_zero(vec3_i64_normalise(vec3_cross(ahead, side))));
    const struct vec3 right = vec3_i64_normalise(vec3_cross(ahead, side));
    struct view view;
    view_set(&view, eye, right, ahead, vec3_i64_normalise(vec3_cross(right, ahead)), 100U * 256U,
             200, 200);
    const uint32_t over_count = pictured(&m->tree, &m->overlay, &view, over);
    const uint32_t other_count = pictured(anew, NULL, &view, other);
    uint32_t wanted = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (is_in_picture(&view, points[i])) {
            points[wanted++] = points[i];
        }
    }
    qsort(points, wanted, sizeof *points, by_place);
    pictured_in_all += wanted;
    CHECK_EQ(over_count, wanted);
    CHECK_EQ(other_count, wanted);
    CHECK(memcmp(over, points, wanted * sizeof *points) == 0);
    CHECK(memcmp(other, points, wanted * sizeof *points) == 0);
}

static void look(const struct model *m, bool pictures) {
    static struct vec3 points[POINTS_MOST];
    in_order(m);
    const uint32_t count = gather_all(m, points);
    if (!check_clean()) {
        return;
    }
    void *block = NULL;
    const struct vec3 eye = somewhere(1 << (24U + solid_below(&seed, 6)));
    if (count == 0U) {
        const struct scene_aim_options options = {.eye = eye, .overlay = &m->overlay};
        struct scene_aim_result result;
        CHECK_EQ(scene_aim(&m->tree, &options, &memory, &result), SCENE_AIM_EMPTY);
        return;
    }
    const struct tree anew = build_anew(points, count, &block);
    aims_are_equal(m, &anew, eye, points, count);
    if (pictures) {
        pictures_are_equal(m, &anew, somewhere(1 << 26), points, count);
    }
    free(block);
}

static void run(enum scene_shape shape, bool flat, unsigned long changes) {
    const struct scene_set set = {shape, 4000, 120, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    struct scene_build_options options = scene_build_default;
    options.coarse_px_q8 = 0;
    options.flat = flat;
    static struct model m;
    void *block;
    memset(&m, 0, sizeof m);
    scene_set_open(&scene, &options, &block, &m.tree);
    const uint32_t parts = m.tree.header->part_count;
    m.few = flat;
    m.away = calloc(parts, sizeof *m.away);
    m.objects = malloc(parts * sizeof *m.objects);
    for (uint32_t i = 0; i < parts; i++) {
        if (m.tree.parts[i].name != TREE_NONE) {
            m.objects[m.object_count++] = i;
        }
    }
    const size_t room = OVERLAY_WORKSPACE_BYTES(parts, ITEMS);
    void *const workspace = malloc(room);
    CHECK_EQ(overlay_open(&m.overlay, &m.tree, ITEMS, workspace, room), OVERLAY_OK);
    look(&m, shape != SCENE_DETAIL);
    uint64_t most = 0;
    reads_over = reads_anew = opened_over = opened_anew = pictured_in_all = 0;
    for (unsigned long i = 0; i < changes && check_clean(); i++) {
        const uint64_t before = m.overlay.nodes_touched;
        change(&m);
        const uint64_t touched = m.overlay.nodes_touched - before;
        most = touched > most ? touched : most;
        if (i < 20U || i % (changes / look_count + 1U) == 0U || i + 1U == changes) {
            look(&m, shape != SCENE_DETAIL);
        }
    }
    // Two paths of at most 13 levels for 150 items, three nodes written a level at most.
    CHECK(most <= 6U * 13U + 2U);
    printf("# %-7s %lu changes, %.2f nodes written each, at most %llu; reads of an aim %.0f (built "
           "anew %.0f), nodes opened %.0f (%.0f); %.0f points in a picture\n",
           scene_shape_names[shape], changes, (double)m.overlay.nodes_touched / (double)changes,
           (unsigned long long)most, (double)reads_over / (double)look_count,
           (double)reads_anew / (double)look_count, (double)opened_over / (double)look_count,
           (double)opened_anew / (double)look_count, (double)pictured_in_all / (double)look_count);
    free(workspace);
    free(m.away);
    free(m.objects);
    free(block);
    scene_text_free(&scene);
}

static void in_a_box(void) {
    run(SCENE_BOX, false, change_count);
}

/// A node of 120 objects: as a file of another program may be.
static void in_a_wide_tree(void) {
    run(SCENE_BOX, true, change_count / 20U);
}

static void in_nested_groups(void) {
    run(SCENE_DETAIL, false, change_count / 4U);
}

/// How long a change takes with so many items in so large a scene.
static void takes_little(void) {
    enum { MANY = 10000, MOVES = 200000 };
    const struct scene_set set = {SCENE_BALL, 100000, 1000, false};
    struct scene_text scene = scene_set_draw(&set, &seed);
    void *block;
    struct tree tree;
    scene_set_open(&scene, &scene_build_default, &block, &tree);
    const size_t room = OVERLAY_WORKSPACE_BYTES(tree.header->part_count, MANY);
    void *const workspace = malloc(room);
    struct overlay overlay;
    CHECK_EQ(overlay_open(&overlay, &tree, MANY, workspace, room), OVERLAY_OK);
    for (uint32_t i = 0; i < MANY; i++) {
        uint32_t part, item;
        do {
            part = solid_below(&seed, tree.header->part_count);
        } while (tree.parts[part].name == TREE_NONE);
        CHECK_EQ(overlay_add_object(&overlay, part, somewhere(1 << 26), &item), OVERLAY_OK);
    }
    const double start = seconds();
    for (int i = 0; i < MOVES; i++) {
        const uint32_t which = solid_below(&seed, MANY);
        CHECK_EQ(overlay_move(&overlay, which, somewhere(1 << 26)), OVERLAY_OK);
    }
    printf("# %d items in %.0f KiB: %.2f us a move anywhere; height %u\n", MANY,
           (double)room / 1024.0, (seconds() - start) / MOVES * 1e6,
           overlay.nodes[overlay.root].height);
    CHECK(overlay.nodes[overlay.root].height <= 18U);
    free(workspace);
    free(block);
    scene_text_free(&scene);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *changes = getenv("CHANGES");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19750607U;
    change_count = changes != NULL ? strtoul(changes, NULL, 0) : change_count;
    printf("# seed %llu, %lu changes\n", (unsigned long long)seed, change_count);
    TEST(in_a_box);
    TEST(in_a_wide_tree);
    TEST(in_nested_groups);
    TEST(takes_little);
    return check_finish();
}

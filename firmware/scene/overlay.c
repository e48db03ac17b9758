#include "scene/overlay.h"

#include "fixed/root.h"

/// Holds everything within TREE_COORDINATE_MAX: sqrt(3) * 2^30, rounded up.
static const struct overlay_sphere everything = {{0, 0, 0}, 1859775394U};

static uint32_t distance_up(struct vec3 a, struct vec3 b) {
    const int64_t x = (int64_t)a.x - b.x, y = (int64_t)a.y - b.y, z = (int64_t)a.z - b.z;
    // Differences below 2^31: the sum is below 2^64, its root below 2^32.
    const uint64_t square = (uint64_t)(x * x) + (uint64_t)(y * y) + (uint64_t)(z * z);
    const uint32_t root = root_u64(square);
    return (uint64_t)root * root < square ? root + 1U : root;
}

/// A sphere around two, as small as whole units let it be.
static struct overlay_sphere around(struct overlay_sphere a, struct overlay_sphere b) {
    const uint64_t apart = distance_up(a.center, b.center);
    if (apart + b.radius <= a.radius || apart + a.radius <= b.radius) {
        return a.radius >= b.radius ? a : b;
    }
    // From a's centre toward b's: below `apart`, since neither holds the other.
    const int64_t along = (int64_t)((apart + b.radius - a.radius) / 2U), whole = (int64_t)apart;
    const struct vec3 center =
        vec3((int32_t)(a.center.x + ((int64_t)b.center.x - a.center.x) * along / whole),
             (int32_t)(a.center.y + ((int64_t)b.center.y - a.center.y) * along / whole),
             (int32_t)(a.center.z + ((int64_t)b.center.z - a.center.z) * along / whole));
    const uint64_t to_a = (uint64_t)distance_up(center, a.center) + a.radius,
                   to_b = (uint64_t)distance_up(center, b.center) + b.radius;
    const uint64_t radius = to_a > to_b ? to_a : to_b;
    return radius < everything.radius ? (struct overlay_sphere){center, (uint32_t)radius}
                                      : everything;
}

// ---------------------------------------------------------------- objects and their places

/// Is anything left in its place below a cluster?
static bool has_any(const struct overlay *o, const struct tree_node *node) {
    for (uint32_t k = 0; k < node->description_count; k++) {
        const struct tree_description *const d =
            &o->tree->descriptions[node->first_description + k];
        for (uint32_t i = d->first; tree_kind(d) == TREE_NODES && i < d->first + d->count; i++) {
            if (!overlay_is_away(o, o->tree->nodes[i].part)) {
                return true;
            }
        }
        if (tree_kind(d) == TREE_POINTS) {
            return true;
        }
    }
    return false;
}

static void set_bit(struct overlay *o, uint32_t part, bool away) {
    const uint32_t bit = UINT32_C(1) << part % 32U;
    o->away[part / 32U] = (o->away[part / 32U] & ~bit) | (away ? bit : 0U);
    o->nodes_touched++;
}

static bool is_object(const struct tree *tree, uint32_t part) {
    return part < tree->header->part_count && tree->parts[part].name != TREE_NONE;
}

enum overlay_status overlay_set_away(struct overlay *o, uint32_t part, bool away) {
    if (!is_object(o->tree, part)) {
        return OVERLAY_ERROR_OBJECT;
    }
    // Up as far as something changes; parents come before their parts, so it ends.
    for (uint32_t at = part; at != TREE_NONE && overlay_is_away(o, at) != away;
         at = o->tree->parts[at].parent) {
        if (at != part && away && has_any(o, &o->tree->nodes[o->tree->parts[at].node])) {
            break;
        }
        set_bit(o, at, away);
    }
    return OVERLAY_OK;
}

// ---------------------------------------------------------------- the tree of items

static bool is_leaf(const struct overlay_node *node) {
    return node->child[0] == OVERLAY_NONE;
}

static uint32_t take_node(struct overlay *o) {
    const uint32_t node = o->free_node;
    o->free_node = o->nodes[node].parent;
    return node;
}

static void give_node(struct overlay *o, uint32_t node) {
    o->nodes[node].parent = o->free_node;
    o->free_node = node;
}

/// Sphere and height from the children.
static void refit(struct overlay *o, uint32_t at) {
    struct overlay_node *const node = &o->nodes[at];
    const struct overlay_node *const a = &o->nodes[node->child[0]], *const b =
                                                                        &o->nodes[node->child[1]];
    node->sphere = around(a->sphere, b->sphere);
    node->height = 1U + (a->height > b->height ? a->height : b->height);
    o->nodes_touched++;
}

/// Puts `by` where `at` hangs.
static void replace(struct overlay *o, uint32_t at, uint32_t by) {
    const uint32_t parent = o->nodes[at].parent;
    o->nodes[by].parent = parent;
    if (parent == OVERLAY_NONE) {
        o->root = by;
    } else {
        o->nodes[parent].child[o->nodes[parent].child[0] == at ? 0 : 1] = by;
    }
}

/// If one child is higher than the other by two it comes up, keeps its higher child, and leaves
/// the other one to the node. Leaves have no order, so one turn is always enough. Returns: the node
/// now at that place.
static uint32_t balance(struct overlay *o, uint32_t at) {
    struct overlay_node *const node = &o->nodes[at];
    const uint32_t left = o->nodes[node->child[0]].height, right = o->nodes[node->child[1]].height;
    if (left <= right + 1U && right <= left + 1U) {
        return at;
    }
    const unsigned side = left > right ? 0U : 1U;
    const uint32_t up = node->child[side];
    struct overlay_node *const risen = &o->nodes[up];
    const unsigned higher =
        o->nodes[risen->child[0]].height >= o->nodes[risen->child[1]].height ? 0U : 1U;
    const uint32_t given = risen->child[1U - higher];
    replace(o, at, up);
    risen->child[1U - higher] = at;
    node->parent = up;
    node->child[side] = given;
    o->nodes[given].parent = at;
    refit(o, at);
    refit(o, up);
    return up;
}

/// From a node up to the root: balance, sphere, height.
static void mend(struct overlay *o, uint32_t at) {
    while (at != OVERLAY_NONE) {
        at = balance(o, at);
        refit(o, at);
        at = o->nodes[at].parent;
    }
}

/// How likely a view meets a sphere, in some unit; below 2^62.
static int64_t cost_of(struct overlay_sphere sphere) {
    return (int64_t)sphere.radius * sphere.radius;
}

/// The leaf beside which to put a new one: down to where its ancestors grow least. Always down to a
/// leaf, so that no height changes by more than one and a turn mends it.
static uint32_t find_place(const struct overlay *o, struct overlay_sphere sphere) {
    uint32_t at = o->root;
    while (!is_leaf(&o->nodes[at])) {
        int64_t cost[2];
        for (unsigned i = 0; i < 2U; i++) {
            const struct overlay_node *const child = &o->nodes[o->nodes[at].child[i]];
            cost[i] = cost_of(around(child->sphere, sphere)) -
                      (is_leaf(child) ? 0 : cost_of(child->sphere));
        }
        at = o->nodes[at].child[cost[1] < cost[0] ? 1 : 0];
    }
    return at;
}

static void insert(struct overlay *o, uint32_t leaf) {
    o->nodes[leaf].parent = OVERLAY_NONE;
    o->nodes_touched++;
    if (o->root == OVERLAY_NONE) {
        o->root = leaf;
        return;
    }
    const uint32_t beside = find_place(o, o->nodes[leaf].sphere), parent = take_node(o);
    replace(o, beside, parent);
    o->nodes[parent].child[0] = beside;
    o->nodes[parent].child[1] = leaf;
    o->nodes[beside].parent = parent;
    o->nodes[leaf].parent = parent;
    mend(o, parent);
}

static void take_out(struct overlay *o, uint32_t leaf) {
    const uint32_t parent = o->nodes[leaf].parent;
    if (parent == OVERLAY_NONE) {
        o->root = OVERLAY_NONE;
        return;
    }
    const struct overlay_node *const node = &o->nodes[parent];
    replace(o, parent, node->child[node->child[0] == leaf ? 1 : 0]);
    const uint32_t above = node->parent;
    give_node(o, parent);
    mend(o, above);
}

// ---------------------------------------------------------------- items

static bool is_within(struct overlay_sphere sphere) {
    const int64_t most = (int64_t)TREE_COORDINATE_MAX - sphere.radius;
    const struct vec3 c = sphere.center;
    return c.x >= -most && c.x <= most && c.y >= -most && c.y <= most && c.z >= -most &&
           c.z <= most;
}

/// A sphere moved. False: part of it would be beyond TREE_COORDINATE_MAX.
static bool moved(struct overlay_sphere sphere, struct vec3 by, struct overlay_sphere *out) {
    const int64_t x = (int64_t)sphere.center.x + by.x, y = (int64_t)sphere.center.y + by.y,
                  z = (int64_t)sphere.center.z + by.z;
    const int64_t most = TREE_COORDINATE_MAX;
    if (x < -most || x > most || y < -most || y > most || z < -most || z > most) {
        return false;
    }
    *out = (struct overlay_sphere){vec3((int32_t)x, (int32_t)y, (int32_t)z), sphere.radius};
    return is_within(*out);
}

/// Around an item's points, without its offset.
static struct overlay_sphere sphere_of(const struct overlay *o, const struct overlay_item *item) {
    if (item->points == NULL) {
        const struct tree_node *const node =
            &o->tree->nodes[o->tree->parts[item->part_or_count].node];
        return (struct overlay_sphere){tree_center(node), node->radius};
    }
    struct vec3 low = vec3(INT32_MAX, INT32_MAX, INT32_MAX),
                high = vec3(INT32_MIN, INT32_MIN, INT32_MIN);
    for (uint32_t i = 0; i < item->part_or_count; i++) {
        const struct tree_point *const p = &item->points[i];
        low = vec3(p->x < low.x ? p->x : low.x, p->y < low.y ? p->y : low.y,
                   p->z < low.z ? p->z : low.z);
        high = vec3(p->x > high.x ? p->x : high.x, p->y > high.y ? p->y : high.y,
                    p->z > high.z ? p->z : high.z);
    }
    struct overlay_sphere sphere = {vec3((int32_t)(((int64_t)low.x + high.x) / 2),
                                         (int32_t)(((int64_t)low.y + high.y) / 2),
                                         (int32_t)(((int64_t)low.z + high.z) / 2)),
                                    0};
    for (uint32_t i = 0; i < item->part_or_count; i++) {
        const uint32_t far = distance_up(
            sphere.center, vec3(item->points[i].x, item->points[i].y, item->points[i].z));
        sphere.radius = far > sphere.radius ? far : sphere.radius;
    }
    return sphere;
}

static enum overlay_status add(struct overlay *o, struct overlay_item item, uint32_t *out) {
    struct overlay_sphere sphere;
    if (o->free_item == OVERLAY_NONE) {
        return OVERLAY_ERROR_CAPACITY;
    }
    if (!moved(sphere_of(o, &item), item.offset, &sphere)) {
        return OVERLAY_ERROR_RANGE;
    }
    *out = o->free_item;
    const uint32_t next = o->items[*out].leaf & ~OVERLAY_FREE;
    o->free_item = next == OVERLAY_ITEMS_MAX ? OVERLAY_NONE : next;
    item.leaf = take_node(o);
    o->items[*out] = item;
    o->nodes[item.leaf] = (struct overlay_node){sphere, OVERLAY_NONE, {OVERLAY_NONE, *out}, 0};
    insert(o, item.leaf);
    o->item_count++;
    return OVERLAY_OK;
}

enum overlay_status overlay_add_object(struct overlay *o, uint32_t part, struct vec3 offset,
                                       uint32_t *item) {
    if (!is_object(o->tree, part)) {
        return OVERLAY_ERROR_OBJECT;
    }
    return add(o, (struct overlay_item){NULL, part, offset, 0}, item);
}

enum overlay_status overlay_add_points(struct overlay *o, const struct tree_point *points,
                                       uint32_t count, struct vec3 offset, uint32_t *item) {
    if (points == NULL || count == 0U) {
        return OVERLAY_ERROR_OBJECT;
    }
    for (uint32_t i = 0; i < count; i++) {
        const int32_t most = TREE_COORDINATE_MAX;
        const struct tree_point *const p = &points[i];
        if (p->x < -most || p->x > most || p->y < -most || p->y > most || p->z < -most ||
            p->z > most) {
            return OVERLAY_ERROR_RANGE;
        }
    }
    return add(o, (struct overlay_item){points, count, offset, 0}, item);
}

static bool is_item(const struct overlay *o, uint32_t item) {
    return item < o->item_room && (o->items[item].leaf & OVERLAY_FREE) == 0U;
}

enum overlay_status overlay_move(struct overlay *o, uint32_t item, struct vec3 offset) {
    if (!is_item(o, item)) {
        return OVERLAY_ERROR_OBJECT;
    }
    struct overlay_item *const it = &o->items[item];
    struct overlay_node *const leaf = &o->nodes[it->leaf];
    // From where it is, so that the caller's points are not read again.
    const int64_t x = (int64_t)offset.x - it->offset.x, y = (int64_t)offset.y - it->offset.y,
                  z = (int64_t)offset.z - it->offset.z;
    const int64_t most = 2 * (int64_t)TREE_COORDINATE_MAX;
    struct overlay_sphere sphere;
    if (x < -most || x > most || y < -most || y > most || z < -most || z > most ||
        !moved(leaf->sphere, vec3((int32_t)x, (int32_t)y, (int32_t)z), &sphere)) {
        return OVERLAY_ERROR_RANGE;
    }
    take_out(o, it->leaf);
    leaf->sphere = sphere;
    it->offset = offset;
    insert(o, it->leaf);
    return OVERLAY_OK;
}

enum overlay_status overlay_remove(struct overlay *o, uint32_t item) {
    if (!is_item(o, item)) {
        return OVERLAY_ERROR_OBJECT;
    }
    take_out(o, o->items[item].leaf);
    give_node(o, o->items[item].leaf);
    o->items[item].leaf =
        OVERLAY_FREE | (o->free_item == OVERLAY_NONE ? OVERLAY_ITEMS_MAX : o->free_item);
    o->free_item = item;
    o->item_count--;
    return OVERLAY_OK;
}

enum overlay_status overlay_open(struct overlay *o, const struct tree *tree, uint32_t items,
                                 void *workspace, size_t workspace_bytes) {
    const uint32_t parts = tree->header->part_count;
    if (items > OVERLAY_ITEMS_MAX || workspace_bytes < OVERLAY_WORKSPACE_BYTES(parts, items)) {
        return OVERLAY_ERROR_WORKSPACE;
    }
    const uint32_t words = (parts + 63U) / 64U * 2U;
    *o = (struct overlay){.tree = tree, .item_room = items, .root = OVERLAY_NONE};
    o->away = workspace;
    o->items = (struct overlay_item *)(void *)(o->away + words);
    o->nodes = (struct overlay_node *)(void *)(o->items + items);
    for (uint32_t i = 0; i < words; i++) {
        o->away[i] = 0;
    }
    for (uint32_t i = 0; i < items; i++) {
        o->items[i].leaf = OVERLAY_FREE | (i + 1U < items ? i + 1U : OVERLAY_ITEMS_MAX);
    }
    for (uint32_t i = 0; i < 2U * items; i++) {
        o->nodes[i].parent = i + 1U;
    }
    o->free_item = items != 0U ? 0U : OVERLAY_NONE;
    return OVERLAY_OK;
}

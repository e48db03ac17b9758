#include "scene_build.h"

#include "scene_nodes.h"

#include <stdlib.h>
#include <string.h>

const struct scene_build_options scene_build_default = {4, 128, false, NULL};

enum { CHILDREN_MOST = 4 };

static void *grown(struct build *b, void *array, uint32_t wanted, uint32_t *room, size_t size) {
    if (wanted <= *room) {
        return array;
    }
    const uint32_t more = *room < 512U ? 1024U : *room + *room / 2U;
    const uint32_t next = more < wanted ? wanted : more;
    void *const bigger = realloc(array, next * size);
    if (bigger == NULL) {
        b->failed = true;
        return array;
    }
    *room = next;
    return bigger;
}

/// UINT32_MAX: no memory.
static uint32_t add_node(struct build *b, struct build_node node) {
    b->nodes = grown(b, b->nodes, b->node_count + 1U, &b->node_room, sizeof *b->nodes);
    if (b->failed) {
        return UINT32_MAX;
    }
    b->nodes[b->node_count] = node;
    return b->node_count++;
}

static uint32_t add_parent(struct build *b, const uint32_t *children, uint32_t count,
                           uint32_t thresholds) {
    b->kids = grown(b, b->kids, b->kid_count + count, &b->kid_room, sizeof *b->kids);
    if (b->failed) {
        return UINT32_MAX;
    }
    struct build_node node = {UINT32_MAX, 0, b->kid_count, count, thresholds, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        const struct build_node *const child = &b->nodes[children[i]];
        b->kids[b->kid_count++] = children[i];
        node.first = child->first < node.first ? child->first : node.first;
        node.count += child->count;
    }
    return add_node(b, node);
}

/// Cuts a range again and again at its largest part until there are CHILDREN_MOST.
static uint32_t split(struct cluster_point *points, uint32_t count, uint32_t whole, unsigned depth,
                      uint32_t *end) {
    uint32_t parts = 1;
    // Where cuts have been so uneven that the levels could run out: from here on in halves.
    const bool even = depth < 15U && (uint64_t)count * 8U >= (uint64_t)whole << (2U * depth);
    end[0] = count;
    while (parts < CHILDREN_MOST) {
        uint32_t largest = 0, size = 0;
        for (uint32_t i = 0; i < parts; i++) {
            const uint32_t from = i == 0U ? 0U : end[i - 1U];
            if (end[i] - from > size) {
                size = end[i] - from;
                largest = i;
            }
        }
        if (size <= whole) {
            break;
        }
        const uint32_t from = largest == 0U ? 0U : end[largest - 1U];
        const uint32_t cut = from + cluster_cut(points + from, size, whole, even);
        memmove(end + largest + 1U, end + largest, (parts - largest) * sizeof *end);
        end[largest] = cut;
        parts++;
    }
    return parts;
}

/// A node on the points order[first..first+count).
static uint32_t build_points(struct build *b, uint32_t first, uint32_t count, unsigned depth) {
    const uint32_t whole = b->options->flat ? count : b->options->points_a_leaf;
    if (count <= whole || b->failed || depth == 0U) {
        b->too_deep = b->too_deep || count > whole;
        return add_node(b, (struct build_node){first, count, 0, 0, 0, 0, 0});
    }
    uint32_t end[CHILDREN_MOST], child[CHILDREN_MOST];
    const uint32_t parts = split(b->order + first, count, whole, depth - 1U, end);
    for (uint32_t i = 0; i < parts; i++) {
        const uint32_t from = i == 0U ? 0U : end[i - 1U];
        child[i] = build_points(b, first + from, end[i] - from, depth - 1U);
    }
    return b->failed ? UINT32_MAX : add_parent(b, child, parts, 0);
}

/// A node above objects.
static uint32_t add_cluster(struct build *b, const uint32_t *children, uint32_t count) {
    const uint32_t node = add_parent(b, children, count, 0);
    if (!b->failed) {
        b->nodes[node].object = BUILD_CLUSTER;
    }
    return node;
}

/// A node above some nodes; items[] holds their centres, with the node as source.
static uint32_t build_items(struct build *b, struct cluster_point *items, uint32_t count,
                            unsigned depth) {
    if (count == 1U || b->failed) {
        return items[0].source;
    }
    uint32_t end[CHILDREN_MOST] = {count}, child[CHILDREN_MOST];
    if (b->options->flat || depth == 0U) {
        b->too_deep = b->too_deep || depth == 0U;
        uint32_t *const all = malloc(count * sizeof *all);
        if (all == NULL) {
            b->failed = true;
            return UINT32_MAX;
        }
        for (uint32_t i = 0; i < count; i++) {
            all[i] = items[i].source;
        }
        const uint32_t node = add_cluster(b, all, count);
        free(all);
        return node;
    }
    const uint32_t parts = split(items, count, 1, depth - 1U, end);
    for (uint32_t i = 0; i < parts; i++) {
        const uint32_t from = i == 0U ? 0U : end[i - 1U];
        child[i] = build_items(b, items + from, end[i] - from, depth - 1U);
    }
    return b->failed ? UINT32_MAX : add_cluster(b, child, parts);
}

/// The middle of the box of a node's points.
static struct cluster_point middle_of(const struct build *b, uint32_t node) {
    const struct build_node *const n = &b->nodes[node];
    const struct cluster_box box = cluster_box(b->order + n->first, n->count);
    return (struct cluster_point){(box.low[0] + box.high[0]) / 2, (box.low[1] + box.high[1]) / 2,
                                  (box.low[2] + box.high[2]) / 2, node, n->count};
}

static uint32_t build_object(struct build *b, const struct scene_object *object) {
    uint32_t *const child = malloc(object->detail_count * sizeof *child);
    if (child == NULL) {
        b->failed = true;
        return UINT32_MAX;
    }
    for (uint32_t k = 0; k < object->detail_count; k++) {
        const struct scene_detail *const d = &b->scene->details[object->first_detail + k];
        const uint32_t first = b->order_count;
        for (uint32_t i = 0; i < d->count; i++) {
            const uint32_t v = b->scene->points[d->first + i];
            const struct vec3 p = b->scene->vertices.directions[v];
            b->order[b->order_count++] = (struct cluster_point){p.x, p.y, p.z, v, 1};
        }
        child[k] = build_points(b, first, d->count, 24);
        if (!b->failed) {
            b->nodes[child[k]].detail = object->first_detail + k + 1U;
        }
    }
    const uint32_t node = b->failed                    ? UINT32_MAX
                          : object->detail_count == 1U ? child[0]
                                                       : add_parent(b, child, object->detail_count,
                                                                    object->first_detail + 1U);
    free(child);
    if (!b->failed) {
        b->nodes[node].object = (uint32_t)(object - b->scene->objects) + 1U;
    }
    return node;
}

/// All that is directly in a group (-1: in none), as one node; UINT32_MAX: nothing.
static uint32_t build_group(struct build *b, int32_t group, uint32_t *next_object) {
    const struct scene_text *const s = b->scene;
    struct cluster_point *items = NULL;
    uint32_t count = 0, room = 0;
    // Objects and groups stand in the order of the file: what is in a group is together.
    for (uint32_t next_group = (uint32_t)(group + 1); !b->failed;) {
        uint32_t node = UINT32_MAX;
        const bool object =
            *next_object < s->object_count && s->objects[*next_object].group == group;
        while (!object && next_group < s->group_count && s->groups[next_group].parent != group) {
            next_group++;
        }
        if (object) {
            node = build_object(b, &s->objects[(*next_object)++]);
        } else if (next_group < s->group_count) {
            node = build_group(b, (int32_t)next_group++, next_object);
        } else {
            break;
        }
        if (node == UINT32_MAX) {
            continue;
        }
        items = grown(b, items, count + 1U, &room, sizeof *items);
        if (!b->failed) {
            items[count++] = middle_of(b, node);
        }
    }
    const uint32_t node = count == 0U ? UINT32_MAX : build_items(b, items, count, 24);
    free(items);
    return node;
}

/// Brings the points of each node together: clusters of objects are not in the file's order.
static void put_in_order(struct build *b, uint32_t root) {
    uint32_t *const stack = malloc(b->node_count * sizeof *stack);
    struct cluster_point *const order = malloc((b->order_count + 1U) * sizeof *order);
    b->failed = stack == NULL || order == NULL;
    uint32_t depth = 0, placed = 0;
    if (!b->failed) {
        stack[depth++] = root;
    }
    while (depth != 0U) {
        struct build_node *const node = &b->nodes[stack[--depth]];
        if (node->child_count == 0U) {
            memcpy(order + placed, b->order + node->first, node->count * sizeof *order);
            node->first = placed;
            placed += node->count;
        }
        for (uint32_t k = 0; k < node->child_count; k++) {
            stack[depth++] = b->kids[node->child + k];
        }
    }
    for (uint32_t i = 0; i < b->node_count && !b->failed; i++) { // children come before parents
        struct build_node *const node = &b->nodes[i];
        for (uint32_t k = 0; k < node->child_count; k++) {
            const uint32_t first = b->nodes[b->kids[node->child + k]].first;
            node->first = k == 0U || first < node->first ? first : node->first;
        }
    }
    free(stack);
    if (!b->failed) {
        free(b->order);
        b->order = order;
    } else {
        free(order);
    }
}

enum scene_build_status scene_build(const struct scene_text *scene,
                                    const struct scene_build_options *options, void **block,
                                    size_t *size_bytes) {
    struct build b = {.scene = scene, .options = options};
    size_t total = 0;
    for (uint32_t i = 0; i < scene->detail_count; i++) {
        total += scene->details[i].count;
    }
    b.order = malloc((total + 1U) * sizeof *b.order);
    uint32_t next_object = 0, root = UINT32_MAX;
    b.failed = b.order == NULL;
    if (!b.failed) {
        root = build_group(&b, -1, &next_object);
    }
    if (!b.failed && root != UINT32_MAX) {
        put_in_order(&b, root);
    }
    const enum scene_build_status status = b.failed ? SCENE_BUILD_NO_MEMORY
                                           : b.too_deep
                                               ? SCENE_BUILD_TOO_DEEP
                                               : scene_block_write(&b, root, block, size_bytes);
    free(b.order);
    free(b.nodes);
    free(b.kids);
    return status;
}

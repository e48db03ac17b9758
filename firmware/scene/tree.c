#include "scene/tree.h"

uint32_t tree_crc32(uint32_t crc, const void *bytes, size_t size_bytes) {
    static const uint32_t table[16] = {0x00000000U, 0x1DB71064U, 0x3B6E20C8U, 0x26D930ACU,
                                       0x76DC4190U, 0x6B6B51F4U, 0x4DB26158U, 0x5005713CU,
                                       0xEDB88320U, 0xF00F9344U, 0xD6D6A3E8U, 0xCB61B38CU,
                                       0x9B64C2B0U, 0x86D3D2D4U, 0xA00AE278U, 0xBDBDF21CU};
    const uint8_t *const byte = bytes;
    uint32_t rest = ~crc;
    for (size_t i = 0; i < size_bytes; i++) {
        rest = table[(rest ^ byte[i]) & 15U] ^ (rest >> 4);
        rest = table[(rest ^ (uint32_t)(byte[i] >> 4)) & 15U] ^ (rest >> 4);
    }
    return ~rest;
}

static size_t offset_of(const struct tree *tree, const void *place) {
    return (size_t)((const uint8_t *)place - (const uint8_t *)(const void *)tree->header);
}

static bool is_coordinate(int32_t value) {
    return value >= -TREE_COORDINATE_MAX && value <= TREE_COORDINATE_MAX;
}

/// What has been counted so far: each list has to go on where it ended.
struct progress {
    uint32_t descriptions, nodes, points, parts;
};

/// Is the description where it has to be, and what comes after the one before?
static bool is_next_description(const struct tree *tree, const struct tree_node *node, uint32_t k,
                                const struct progress *so_far) {
    const struct tree_header *const h = tree->header;
    const struct tree_description *const d = &tree->descriptions[so_far->descriptions];
    const uint32_t kind = d->kind & ~TREE_BY_DISTANCE;
    const bool far = (d->kind & TREE_BY_DISTANCE) != 0U;
    const uint32_t first = kind == TREE_NODES    ? so_far->nodes
                           : kind == TREE_POINTS ? so_far->points
                                                 : 0U;
    const uint32_t left = kind == TREE_NODES    ? h->node_count - so_far->nodes
                          : kind == TREE_POINTS ? h->point_count - so_far->points
                                                : 1U;
    if (kind > TREE_CENTER || d->first != first || d->count == 0U || d->count > left) {
        return false;
    }
    if (k == 0U) {
        return d->threshold == (far ? UINT32_MAX : 0U);
    }
    const struct tree_description *const before = &tree->descriptions[node->first_description];
    return ((before->kind ^ d->kind) & TREE_BY_DISTANCE) == 0U &&
           (far ? d->threshold <= d[-1].threshold : d->threshold >= d[-1].threshold);
}

/// Parts hang together from the root down to the objects.
static bool is_next_part(const struct tree *tree, uint32_t node, const struct progress *so_far) {
    const struct tree_node *const n = &tree->nodes[node];
    if (n->part == TREE_NONE) {
        return node != 0U || tree->header->part_count == 0U;
    }
    if (n->part != so_far->parts || so_far->parts == tree->header->part_count) {
        return false;
    }
    const struct tree_part *const part = &tree->parts[n->part];
    return part->node == node && (node != 0U || part->parent == TREE_NONE) &&
           (part->name == TREE_NONE || part->name < tree->header->name_bytes);
}

/// Those of a cluster are parts below it; objects have none below.
static bool children_are_parts(const struct tree *tree, uint32_t node,
                               const struct tree_description *d) {
    const uint32_t part = tree->nodes[node].part;
    const bool cluster = part != TREE_NONE && tree->parts[part].name == TREE_NONE;
    for (uint32_t i = d->first; i < d->first + d->count; i++) {
        const uint32_t below = tree->nodes[i].part;
        if (cluster != (below != TREE_NONE) || below == 0U ||
            (cluster && (below >= tree->header->part_count || tree->parts[below].parent != part))) {
            return false;
        }
    }
    return true;
}

/// Do the lists follow each other without gaps, so that the block is a tree?
static enum tree_status check_structure(const struct tree *tree, size_t *fault_offset) {
    const struct tree_header *const h = tree->header;
    struct progress at = {0, 1, 0, 0};
    uint32_t levels = 0, level_end = 0;
    for (uint32_t i = 0; i < h->node_count; i++) {
        const struct tree_node *const node = &tree->nodes[i];
        *fault_offset = offset_of(tree, node);
        if (i == level_end) { // all parents of this level are read: `nodes` is where it ends
            level_end = at.nodes;
            levels++;
        }
        // A node that no description names would never be reached, and one that names itself
        // always.
        if (i >= at.nodes || !is_coordinate(node->x) || !is_coordinate(node->y) ||
            !is_coordinate(node->z) || node->radius > INT32_MAX ||
            node->first_description != at.descriptions || node->description_count == 0U ||
            node->description_count > h->description_count - at.descriptions ||
            !is_next_part(tree, i, &at)) {
            return TREE_ERROR_STRUCTURE;
        }
        at.parts += node->part != TREE_NONE ? 1U : 0U;
        for (uint32_t k = 0; k < node->description_count; k++) {
            const struct tree_description *const d = &tree->descriptions[at.descriptions];
            *fault_offset = offset_of(tree, d);
            if (!is_next_description(tree, node, k, &at) ||
                (tree_kind(d) == TREE_NODES && !children_are_parts(tree, i, d))) {
                return TREE_ERROR_STRUCTURE;
            }
            at.descriptions++;
            at.nodes += tree_kind(d) == TREE_NODES ? d->count : 0U;
            at.points += tree_kind(d) == TREE_POINTS ? d->count : 0U;
        }
    }
    *fault_offset = 0;
    return at.nodes == h->node_count && at.descriptions == h->description_count &&
                   at.points == h->point_count && at.parts == h->part_count &&
                   levels == h->level_count && levels <= TREE_LEVELS_MAX
               ? TREE_OK
               : TREE_ERROR_STRUCTURE;
}

/// Shapes, their elements, the elements' corners: in order, none left over.
static enum tree_status check_shapes(const struct tree *tree, size_t *fault_offset) {
    const struct tree_header *const h = tree->header;
    uint32_t elements = 0, corners = 0;
    for (uint32_t i = 0; i < h->shape_count; i++) {
        const struct tree_shape *const s = &tree->shapes[i];
        *fault_offset = offset_of(tree, s);
        if (s->node >= h->node_count || (i != 0U && s->node <= s[-1].node) ||
            s->kind > TREE_LINES || s->first_element != elements || s->element_count == 0U ||
            s->element_count > h->element_count - elements) {
            return TREE_ERROR_STRUCTURE;
        }
        for (uint32_t k = 0; k < s->element_count; k++, elements++) {
            const struct tree_element *const e = &tree->elements[elements];
            *fault_offset = offset_of(tree, e);
            if (e->kind > TREE_LINE || e->first_corner != corners ||
                e->corner_count < (e->kind == TREE_FACE ? 3U : 2U) ||
                e->corner_count > h->corner_count - corners ||
                (e->kind == TREE_FACE && s->kind == TREE_LINES)) {
                return TREE_ERROR_STRUCTURE;
            }
            corners += e->corner_count;
        }
    }
    *fault_offset = 0;
    if (elements != h->element_count || corners != h->corner_count) {
        return TREE_ERROR_STRUCTURE;
    }
    for (uint32_t i = 0; i < h->corner_count; i++) {
        if (tree->corners[i] >= h->point_count) {
            *fault_offset = offset_of(tree, &tree->corners[i]);
            return TREE_ERROR_STRUCTURE;
        }
    }
    if (h->name_bytes != 0U && tree->names[h->name_bytes - 1U] != '\0') {
        *fault_offset = offset_of(tree, &tree->names[h->name_bytes - 1U]);
        return TREE_ERROR_STRUCTURE;
    }
    return TREE_OK;
}

static enum tree_status check_points(const struct tree *tree, size_t *fault_offset) {
    for (uint32_t i = 0; i < tree->header->point_count; i++) {
        const struct tree_point *const p = &tree->points[i];
        if (!is_coordinate(p->x) || !is_coordinate(p->y) || !is_coordinate(p->z) ||
            p->source >= tree->header->source_count) {
            *fault_offset = offset_of(tree, p);
            return TREE_ERROR_STRUCTURE;
        }
    }
    return TREE_OK;
}

/// How long a block with these counts is.
static uint64_t size_of(const struct tree_header *h) {
    return sizeof *h + (uint64_t)h->node_count * sizeof(struct tree_node) +
           (uint64_t)h->description_count * sizeof(struct tree_description) +
           (uint64_t)h->point_count * sizeof(struct tree_point) +
           (uint64_t)h->part_count * sizeof(struct tree_part) +
           (uint64_t)h->shape_count * sizeof(struct tree_shape) +
           (uint64_t)h->element_count * sizeof(struct tree_element) +
           (uint64_t)h->corner_count * sizeof(uint32_t) + h->name_bytes;
}

static void lay_out(struct tree *tree, const struct tree_header *h) {
    tree->header = h;
    tree->nodes = (const struct tree_node *)(const void *)(h + 1);
    tree->descriptions =
        (const struct tree_description *)(const void *)(tree->nodes + h->node_count);
    tree->points =
        (const struct tree_point *)(const void *)(tree->descriptions + h->description_count);
    tree->parts = (const struct tree_part *)(const void *)(tree->points + h->point_count);
    tree->shapes = (const struct tree_shape *)(const void *)(tree->parts + h->part_count);
    tree->elements = (const struct tree_element *)(const void *)(tree->shapes + h->shape_count);
    tree->corners = (const uint32_t *)(const void *)(tree->elements + h->element_count);
    tree->names = (const char *)(const void *)(tree->corners + h->corner_count);
}

enum tree_status tree_open(const void *block, size_t size_bytes, struct tree *out,
                           size_t *fault_offset) {
    _Static_assert(sizeof(struct tree_header) == TREE_HEADER_BYTES, "as in the file");
    _Static_assert(sizeof(struct tree_node) == 28U, "as in the file");
    _Static_assert(sizeof(struct tree_description) == 16U, "as in the file");
    _Static_assert(sizeof(struct tree_point) == 16U, "as in the file");
    _Static_assert(sizeof(struct tree_part) == 16U, "as in the file");
    _Static_assert(sizeof(struct tree_shape) == 16U, "as in the file");
    _Static_assert(sizeof(struct tree_element) == 12U, "as in the file");
    const struct tree_header *const h = block;
    *fault_offset = 0;
    if (((uintptr_t)block & 3U) != 0U) {
        return TREE_ERROR_ALIGNMENT;
    }
    if (size_bytes < TREE_HEADER_BYTES) {
        *fault_offset = size_bytes;
        return TREE_ERROR_SIZE;
    }
    if (h->magic != TREE_MAGIC || h->version != TREE_VERSION) {
        *fault_offset = h->magic != TREE_MAGIC ? 0U : offsetof(struct tree_header, version);
        return TREE_ERROR_FORMAT;
    }
    const uint64_t wanted = size_of(h);
    if (h->size_bytes != size_bytes || wanted != size_bytes) {
        *fault_offset = offsetof(struct tree_header, size_bytes);
        return TREE_ERROR_SIZE;
    }
    const uint8_t *const bytes = block;
    const size_t covered = offsetof(struct tree_header, node_count);
    if (tree_crc32(0, bytes + covered, size_bytes - covered) != h->crc32) {
        *fault_offset = offsetof(struct tree_header, crc32);
        return TREE_ERROR_CRC;
    }
    lay_out(out, h);
    if (h->node_count == 0U) { // an empty scene: nothing at all
        return wanted == TREE_HEADER_BYTES && h->level_count == 0U ? TREE_OK : TREE_ERROR_STRUCTURE;
    }
    enum tree_status status = check_structure(out, fault_offset);
    if (status == TREE_OK) {
        status = check_shapes(out, fault_offset);
    }
    return status == TREE_OK ? check_points(out, fault_offset) : status;
}

const struct tree_shape *tree_shape_at(const struct tree *tree, uint32_t node) {
    uint32_t low = 0, high = tree->header->shape_count;
    while (low < high) { // the first at the node or behind it
        const uint32_t middle = low + (high - low) / 2U;
        if (tree->shapes[middle].node < node) {
            low = middle + 1U;
        } else {
            high = middle;
        }
    }
    return low < tree->header->shape_count && tree->shapes[low].node == node ? &tree->shapes[low]
                                                                             : NULL;
}

uint32_t tree_find_part(const struct tree *tree, const char *name) {
    for (uint32_t i = 0; i < tree->header->part_count; i++) {
        const uint32_t at = tree->parts[i].name;
        for (size_t k = 0; at != TREE_NONE && tree->names[at + k] == name[k]; k++) {
            if (name[k] == '\0') {
                return i;
            }
        }
    }
    return TREE_NONE;
}

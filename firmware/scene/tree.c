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

/// Do the lists follow each other without gaps, so that the block is a tree?
static enum tree_status check_structure(const struct tree *tree, size_t *fault_offset) {
    const struct tree_header *const h = tree->header;
    uint32_t descriptions = 0, nodes = 1, points = 0, levels = 0, level_end = 0;
    for (uint32_t i = 0; i < h->node_count; i++) {
        const struct tree_node *const node = &tree->nodes[i];
        *fault_offset = offset_of(tree, node);
        if (i == level_end) { // all parents of this level are read: `nodes` is where it ends
            level_end = nodes;
            levels++;
        }
        // A node that no description names would never be reached, and one that names itself
        // always.
        if (i >= nodes || !is_coordinate(node->x) || !is_coordinate(node->y) ||
            !is_coordinate(node->z) || node->radius > INT32_MAX ||
            node->first_description != descriptions || node->description_count == 0U ||
            node->description_count > h->description_count - descriptions) {
            return TREE_ERROR_STRUCTURE;
        }
        for (uint32_t k = 0; k < node->description_count; k++, descriptions++) {
            const struct tree_description *const d = &tree->descriptions[descriptions];
            *fault_offset = offset_of(tree, d);
            const uint32_t first = d->kind == TREE_NODES    ? nodes
                                   : d->kind == TREE_POINTS ? points
                                                            : 0U;
            const uint32_t left = d->kind == TREE_NODES    ? h->node_count - nodes
                                  : d->kind == TREE_POINTS ? h->point_count - points
                                                           : 1U;
            const uint32_t coarser = k == 0U ? 0U : d[-1].radius_px_q8;
            if (d->kind > TREE_CENTER || d->first != first || d->count == 0U || d->count > left ||
                d->radius_px_q8 < coarser || (k == 0U && d->radius_px_q8 != 0U)) {
                return TREE_ERROR_STRUCTURE;
            }
            nodes += d->kind == TREE_NODES ? d->count : 0U;
            points += d->kind == TREE_POINTS ? d->count : 0U;
        }
    }
    *fault_offset = 0;
    return nodes == h->node_count && descriptions == h->description_count &&
                   points == h->point_count && levels == h->level_count && levels <= TREE_LEVELS_MAX
               ? TREE_OK
               : TREE_ERROR_STRUCTURE;
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

enum tree_status tree_open(const void *block, size_t size_bytes, struct tree *out,
                           size_t *fault_offset) {
    _Static_assert(sizeof(struct tree_header) == TREE_HEADER_BYTES, "as in the file");
    _Static_assert(sizeof(struct tree_node) == 24U, "as in the file");
    _Static_assert(sizeof(struct tree_description) == 16U, "as in the file");
    _Static_assert(sizeof(struct tree_point) == 16U, "as in the file");
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
    const uint64_t wanted = TREE_HEADER_BYTES + (uint64_t)h->node_count * 24U +
                            (uint64_t)h->description_count * 16U + (uint64_t)h->point_count * 16U;
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
    out->header = h;
    out->nodes = (const struct tree_node *)(const void *)(bytes + TREE_HEADER_BYTES);
    out->descriptions = (const struct tree_description *)(const void *)(out->nodes + h->node_count);
    out->points =
        (const struct tree_point *)(const void *)(out->descriptions + h->description_count);
    if (h->node_count == 0U) { // an empty scene: nothing at all
        return wanted == TREE_HEADER_BYTES && h->level_count == 0U ? TREE_OK : TREE_ERROR_STRUCTURE;
    }
    const enum tree_status status = check_structure(out, fault_offset);
    return status == TREE_OK ? check_points(out, fault_offset) : status;
}

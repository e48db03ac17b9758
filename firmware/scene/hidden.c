#include "scene/hidden.h"

#include "fixed/sort.h"

#define FAR           (INT32_C(1) << 28)
#define GRID_SIDE_MAX 128U

static const struct hidden_window everything = {-FAR, FAR, -FAR, FAR};

// ---------------------------------------------------------------- memory

struct sizes {
    size_t bounds, pieces, grid_objects, most_vertices, crossings;
};

static struct sizes sizes_of(const struct shape_set *set) {
    struct sizes s = {0, set->object_count, 0, 0, 0};
    for (uint32_t i = 0; i < set->object_count; i++) {
        const struct shape_object *const o = &set->objects[i];
        s.bounds += (size_t)o->face_count + (o->kind == SHAPE_SOLID ? o->edge_count : 0U);
        // A line crosses the outline of a solid twice, and each side of another one once.
        s.crossings += o->kind == SHAPE_SOLID ? 2U : o->edge_count;
        s.pieces += o->kind == SHAPE_PLANE ? o->face_count : 0U;
        for (uint32_t f = o->first_face;
             o->kind == SHAPE_PLANE && f < o->first_face + o->face_count; f++) {
            s.bounds += set->faces[f].corner_count;
        }
        s.most_vertices = o->vertex_count > s.most_vertices ? o->vertex_count : s.most_vertices;
    }
    s.grid_objects = 8U * (size_t)set->object_count + 64U;
    return s;
}

/// Cells a side: about as many as objects in all.
static uint32_t grid_side_for(uint32_t object_count) {
    uint32_t side = 1;
    while (side < GRID_SIDE_MAX && side * side < object_count) {
        side *= 2U;
    }
    return side;
}

/// Hands out parts of a workspace, or adds up what they need.
struct layout {
    unsigned char *at;
    size_t used;
};

static void *take(struct layout *layout, size_t bytes) {
    void *const part = layout->at == NULL ? NULL : layout->at + layout->used;
    layout->used += (bytes + 7U) & ~(size_t)7U;
    return part;
}

static void lay_out(struct hidden *h, const struct shape_set *set, struct layout *layout) {
    const struct sizes s = sizes_of(set);
    const size_t objects = set->object_count, edges = set->edge_count;
    h->set = set;
    h->sight.bounds = take(layout, s.bounds * sizeof *h->sight.bounds);
    h->sight.bound_room = (uint32_t)s.bounds;
    h->sight.pieces = take(layout, s.pieces * sizeof *h->sight.pieces);
    h->sight.piece_room = (uint32_t)s.pieces;
    h->vertices = take(layout, set->vertex_count * sizeof *h->vertices);
    h->objects = take(layout, objects * sizeof *h->objects);
    h->edge_class = take(layout, edges);
    h->extremes = take(layout, edges * sizeof *h->extremes);
    const uint32_t side = grid_side_for(set->object_count);
    h->cell_first = take(layout, ((size_t)side * side + 1U) * sizeof *h->cell_first);
    h->cell_object = take(layout, s.grid_objects * sizeof *h->cell_object);
    h->cell_room = (uint32_t)s.grid_objects;
    h->order = take(layout, objects * sizeof *h->order);
    h->rank = take(layout, objects * sizeof *h->rank);
    h->mark = take(layout, objects * sizeof *h->mark);
    h->near = take(layout, objects * sizeof *h->near);
    h->spare = take(layout, objects * sizeof *h->spare);
    h->spans.room = (uint32_t)(s.pieces + 2U);
    h->spans.spans = take(layout, h->spans.room * sizeof *h->spans.spans);
    h->crossing_room = (uint32_t)(s.crossings + 1U);
    h->crossings = take(layout, h->crossing_room * sizeof *h->crossings);
    h->crossing_order = take(layout, h->crossing_room * sizeof *h->crossing_order);
    h->crossing_spare = take(layout, h->crossing_room * sizeof *h->crossing_spare);
    h->edge_done = take(layout, edges);
    h->invisible = take(layout, s.most_vertices * sizeof *h->invisible);
}

size_t hidden_workspace_bytes(const struct shape_set *set) {
    struct hidden unused;
    struct layout layout = {NULL, 0};
    lay_out(&unused, set, &layout);
    return layout.used;
}

enum hidden_status hidden_open(struct hidden *hidden, const struct shape_set *set, void *workspace,
                               size_t workspace_bytes) {
    struct layout layout = {workspace, 0};
    if (workspace_bytes < hidden_workspace_bytes(set)) {
        return HIDDEN_ERROR_WORKSPACE;
    }
    *hidden = (struct hidden){.workspace_bytes = hidden_workspace_bytes(set)};
    lay_out(hidden, set, &layout);
    return HIDDEN_OK;
}

// ---------------------------------------------------------------- projection

static int64_t along(struct vec3 unit_q30, struct vec3 d) {
    return vec3_dot_unit(unit_q30, d); // |d| below 2^31.1, so below 2^61.2
}

/// across / depth in 1/65536, off by less than HIDDEN_SLACK; held within FAR.
static int32_t tangent_q16(int64_t across, int64_t depth) {
    const unsigned zeros = u64_leading_zeros((uint64_t)depth);
    const unsigned shift = zeros < 34U ? 34U - zeros : 0U; // to below 2^30
    const int64_t z = depth >> shift;
    const bool negative = across < 0;
    const uint64_t x = u64_abs(across) >> shift;
    if (x >= (uint64_t)z << 12) {
        return negative ? -FAR : FAR;
    }
    const int32_t quotient = (int32_t)((x << 16) / (uint64_t)z);
    return negative ? -quotient : quotient;
}

static void project(struct hidden *h) {
    const struct hidden_camera *const c = &h->camera;
    for (uint32_t i = 0; i < h->set->vertex_count; i++) {
        struct hidden_vertex *const v = &h->vertices[i];
        v->place = sight_from_eye(c->eye, h->set->vertices[i]);
        v->across = along(c->right, v->place);
        v->height = along(c->up, v->place);
        v->depth = along(c->ahead, v->place);
        v->x = v->depth > 0 ? tangent_q16(v->across, v->depth) : 0;
        v->y = v->depth > 0 ? tangent_q16(v->height, v->depth) : 0;
    }
}

static void widen(struct hidden_window *w, const struct hidden_vertex *v) {
    w->left = v->x - HIDDEN_SLACK < w->left ? v->x - HIDDEN_SLACK : w->left;
    w->right = v->x + HIDDEN_SLACK > w->right ? v->x + HIDDEN_SLACK : w->right;
    w->low = v->y - HIDDEN_SLACK < w->low ? v->y - HIDDEN_SLACK : w->low;
    w->high = v->y + HIDDEN_SLACK > w->high ? v->y + HIDDEN_SLACK : w->high;
}

static struct hidden_window border_of(const struct hidden_camera *c) {
    const bool none = c->half_width_q16 == 0 || c->half_height_q16 == 0;
    return none ? everything
                : (struct hidden_window){
                      -c->half_width_q16 - HIDDEN_SLACK, c->half_width_q16 + HIDDEN_SLACK,
                      -c->half_height_q16 - HIDDEN_SLACK, c->half_height_q16 + HIDDEN_SLACK};
}

static void place_object(struct hidden *h, uint32_t index, const struct hidden_window *border) {
    const struct shape_object *const o = &h->set->objects[index];
    struct hidden_object *const out = &h->objects[index];
    *out = (struct hidden_object){
        .window = {FAR, -FAR, FAR, -FAR}, .nearest = INT64_MAX, .farthest = INT64_MIN};
    for (uint32_t i = o->first_vertex; i < o->first_vertex + o->vertex_count; i++) {
        const struct hidden_vertex *const v = &h->vertices[i];
        out->nearest = v->depth < out->nearest ? v->depth : out->nearest;
        out->farthest = v->depth > out->farthest ? v->depth : out->farthest;
        widen(&out->window, v);
    }
    out->in_front = out->nearest > 0;
    if (!out->in_front) {
        out->window = everything;
    }
    out->seen = out->farthest > 0 && hidden_windows_meet(&out->window, border);
}

struct hidden_window hidden_edge_window(const struct hidden *h, const struct shape_edge *edge) {
    const struct hidden_vertex *const a = &h->vertices[edge->from], *const b =
                                                                        &h->vertices[edge->to];
    if (a->depth <= 0 || b->depth <= 0) {
        return everything;
    }
    struct hidden_window w = {FAR, -FAR, FAR, -FAR};
    widen(&w, a);
    widen(&w, b);
    return w;
}

// ---------------------------------------------------------------- faces and edges

/// Faces and edges as the eye sees them, outlines, shadows.
static void classify(struct hidden *h, uint32_t index) {
    const struct shape_set *const set = h->set;
    const struct shape_object *const o = &set->objects[index];
    struct hidden_object *const out = &h->objects[index];
    for (uint32_t f = o->first_face; o->kind == SHAPE_SOLID && f < o->first_face + o->face_count;
         f++) {
        h->front_faces += shape_side(&set->planes[f], h->camera.eye) > 0 ? 1U : 0U;
    }
    out->first_extreme = h->extreme_total;
    for (uint32_t e = o->first_edge; e < o->first_edge + o->edge_count; e++) {
        const struct shape_edge *const edge = &set->edges[e];
        enum hidden_class class = o->kind == SHAPE_PLANE ? HIDDEN_EXTREME : HIDDEN_FRONT;
        if (o->kind == SHAPE_SOLID) {
            const bool left = shape_side(&set->planes[edge->left], h->camera.eye) > 0,
                       right = shape_side(&set->planes[edge->right], h->camera.eye) > 0;
            class = left != right ? HIDDEN_EXTREME : (left ? HIDDEN_FRONT : HIDDEN_BACK);
        }
        h->edge_class[e] = (uint8_t) class;
        if (class == HIDDEN_EXTREME) {
            h->extremes[h->extreme_total++] = e;
        }
    }
    out->extreme_count = h->extreme_total - out->first_extreme;
    h->front_faces += o->kind == SHAPE_PLANE ? 1U : 0U;
    out->first_piece = h->sight.piece_count;
    out->piece_count = sight_add(&h->sight, set, index); // there is room: sizes_of
}

// ---------------------------------------------------------------- cells

static bool is_nearer(const void *context, uint32_t a, uint32_t b) {
    const struct hidden *const h = context;
    return h->objects[a].nearest < h->objects[b].nearest;
}

static bool has_lower_rank(const void *context, uint32_t a, uint32_t b) {
    const struct hidden *const h = context;
    return h->rank[a] < h->rank[b];
}

/// Columns or rows of cells that a range takes: first to last.
static void cells_of(const struct hidden *h, int32_t low, int32_t high, int32_t grid_low,
                     int32_t grid_high, uint32_t out[2]) {
    const int64_t size = (int64_t)grid_high - grid_low + 1, side = h->grid_side;
    const int64_t first = ((int64_t)low - grid_low) * side / size,
                  last = ((int64_t)high - grid_low) * side / size;
    out[0] = first < 0 ? 0U : (uint32_t)(first >= side ? side - 1 : first);
    out[1] = last < 0 ? 0U : (uint32_t)(last >= side ? side - 1 : last);
}

struct cells {
    uint32_t column[2], row[2];
};

static struct cells object_cells(const struct hidden *h, const struct hidden_window *w) {
    struct cells cells;
    cells_of(h, w->left, w->right, h->grid.left, h->grid.right, cells.column);
    cells_of(h, w->low, w->high, h->grid.low, h->grid.high, cells.row);
    return cells;
}

/// The box of the windows in sight.
static struct hidden_window box_of(const struct hidden *h, const struct hidden_window *border) {
    struct hidden_window box = {FAR, -FAR, FAR, -FAR};
    for (uint32_t i = 0; i < h->set->object_count; i++) {
        const struct hidden_window *const w = &h->objects[i].window;
        if (h->objects[i].seen && h->objects[i].in_front) {
            box.left = w->left < box.left ? w->left : box.left;
            box.right = w->right > box.right ? w->right : box.right;
            box.low = w->low < box.low ? w->low : box.low;
            box.high = w->high > box.high ? w->high : box.high;
        }
    }
    if (box.left > box.right) {
        return *border;
    }
    box.left = box.left < border->left ? border->left : box.left;
    box.right = box.right > border->right ? border->right : box.right;
    box.low = box.low < border->low ? border->low : box.low;
    box.high = box.high > border->high ? border->high : box.high;
    return box;
}

/// Objects in each cell: counted, or (with `fill`) put in. False: too many for the room.
static bool fill_cells(struct hidden *h, bool fill) {
    const uint32_t cell_count = h->grid_side * h->grid_side;
    uint64_t total = 0;
    if (!fill) {
        for (uint32_t c = 0; c <= cell_count; c++) {
            h->cell_first[c] = 0;
        }
    }
    // Backwards, as each cell is filled from its end.
    for (uint32_t k = h->set->object_count; k-- != 0U;) {
        const uint32_t object = h->order[k];
        if (!h->objects[object].seen) {
            continue;
        }
        const struct cells at = object_cells(h, &h->objects[object].window);
        for (uint32_t row = at.row[0]; row <= at.row[1]; row++) {
            for (uint32_t column = at.column[0]; column <= at.column[1]; column++) {
                const uint32_t cell = row * h->grid_side + column;
                if (fill) {
                    h->cell_object[--h->cell_first[cell]] = object;
                } else {
                    h->cell_first[cell]++;
                }
            }
        }
        total += (uint64_t)(at.row[1] - at.row[0] + 1U) * (at.column[1] - at.column[0] + 1U);
        if (total > h->cell_room) {
            return false;
        }
    }
    for (uint32_t c = 0, sum = 0; !fill && c <= cell_count; c++) {
        sum += h->cell_first[c]; // the end of each cell
        h->cell_first[c] = sum;
    }
    return true;
}

static void make_cells(struct hidden *h, const struct hidden_window *border) {
    const uint32_t count = h->set->object_count;
    for (uint32_t i = 0; i < count; i++) {
        h->order[i] = i;
        h->mark[i] = 0;
    }
    h->stamp = 0;
    sort_indices(h->order, h->spare, count, is_nearer, h);
    for (uint32_t i = 0; i < count; i++) {
        h->rank[h->order[i]] = i;
    }
    h->grid = box_of(h, border);
    h->grid_side = grid_side_for(count);
    while (!fill_cells(h, false)) {
        h->grid_side /= 2U; // with a single cell there is room
    }
    (void)fill_cells(h, true);
}

uint32_t hidden_neighbours(struct hidden *h, uint32_t object) {
    const struct hidden_object *const own = &h->objects[object];
    const struct cells at = object_cells(h, &own->window);
    uint32_t count = 0;
    h->stamp++; // marks stay from call to call
    h->mark[object] = h->stamp;
    for (uint32_t row = at.row[0]; row <= at.row[1]; row++) {
        for (uint32_t column = at.column[0]; column <= at.column[1]; column++) {
            const uint32_t cell = row * h->grid_side + column;
            for (uint32_t k = h->cell_first[cell]; k < h->cell_first[cell + 1U]; k++) {
                const uint32_t other = h->cell_object[k];
                // Depth grows along each ray: what begins no nearer than this ends hides nothing.
                if (h->objects[other].nearest >= own->farthest) {
                    break;
                }
                if (h->mark[other] != h->stamp) {
                    h->mark[other] = h->stamp;
                    if (hidden_windows_meet(&own->window, &h->objects[other].window)) {
                        h->near[count++] = other;
                    }
                }
            }
        }
    }
    sort_indices(h->near, h->spare, count, has_lower_rank, h);
    return count;
}

void hidden_look(struct hidden *hidden, const struct hidden_camera *camera) {
    hidden->border = border_of(camera);
    hidden->camera = *camera;
    hidden->sight.eye = camera->eye;
    hidden->sight.bound_count = hidden->sight.piece_count = 0;
    hidden->front_faces = hidden->extreme_total = 0;
    project(hidden);
    for (uint32_t i = 0; i < hidden->set->object_count; i++) {
        place_object(hidden, i, &hidden->border);
        classify(hidden, i);
    }
    make_cells(hidden, &hidden->border);
}

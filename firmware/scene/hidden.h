/// Lines of a scene that are not hidden: by two methods that draw the same picture.
///
/// hidden_clip, for real work: each edge is clipped by the shadow of each object whose window meets
/// its own, the nearest first, until nothing of it is left.
/// hidden_levine: the thesis' pipeline in its seven steps, with its counters. Both decide by exact
/// integers, so the parts they give are equal as fractions (tests/property/hidden.c, which follows
/// a ray through the middle of each part and each gap, in rational numbers).
/// Source: Levine 1975, chapter VI, as corrected in docs/geometry.md, "Hidden lines".
#ifndef SCENE_HIDDEN_H
#define SCENE_HIDDEN_H

#include "scene/separate.h"
#include "scene/sight.h"

/// Directions in Q1.30, at right angles as well as their rounding lets them.
struct hidden_camera {
    struct vec3 eye; ///< within TREE_COORDINATE_MAX
    struct vec3 right, ahead, up;
    /// Half the picture's width and height at distance 1, in 1/65536; 0: no border. What is outside
    /// of the border as a whole is left out, what crosses it is not cut.
    int32_t half_width_q16, half_height_q16;
};

/// A visible part of an edge, in front of the plane of the eye; from its `from` to its `to`.
struct hidden_segment {
    uint32_t object, edge;
    struct span part;
};

struct hidden_sink {
    void (*segment)(void *context, const struct hidden_segment *segment);
    void *context;
};

/// What appendix III of the thesis counts. `start`: for the invisibility of a first vertex ("/I"),
/// `line`: for the edges ("/HL").
struct hidden_counters {
    uint64_t front_faces;                               ///< FF
    uint64_t start_objects, start_windows, start_edges; ///< OC/I, OW/I, EEC/I
    uint64_t start_intersections;                       ///< IC/I
    uint64_t edges;                                     ///< ED
    uint64_t line_objects, line_windows, line_edges;    ///< OC/HL, OW/HL, EEC/HL
    uint64_t line_intersections, line_actual;           ///< IC/HL, AI/HL
    /// Not in the thesis: pairs of an edge and an object with a vertex exactly on the line of the
    /// other, or that reach the plane of the eye, which are clipped.
    uint64_t clipped_pairs;
};

enum hidden_class { HIDDEN_BACK, HIDDEN_FRONT, HIDDEN_EXTREME };

/// In the picture: tangents in 1/65536, off by less than HIDDEN_SLACK; beyond 2^28 they stay there.
struct hidden_window {
    int32_t left, right, low, high;
};
#define HIDDEN_SLACK 2

struct hidden_vertex {
    struct vec3 place;             ///< relative to the eye
    int32_t x, y;                  ///< of the picture; only if depth is above 0
    int64_t across, height, depth; ///< along right, up, ahead; in units of 2^-30
};

struct hidden_object {
    struct hidden_window window; ///< everything, if it reaches the plane of the eye
    int64_t nearest, farthest;   ///< depth
    uint32_t first_piece, piece_count;
    uint32_t first_extreme, extreme_count;
    bool in_front; ///< as a whole
    bool seen;     ///< some of it is in front, and within the border
};

struct hidden_crossing {
    struct fraction at;
    int32_t change; ///< 1: goes behind; -1: comes out
};

struct hidden {
    const struct shape_set *set;
    struct hidden_camera camera;
    struct sight sight;
    struct hidden_vertex *vertices;
    struct hidden_object *objects;
    uint8_t *edge_class; ///< enum hidden_class
    uint32_t *extremes;  ///< outlines, by object
    struct hidden_window border;
    // Windows in cells: the objects in front first.
    struct hidden_window grid;
    uint32_t grid_side, *cell_first, *cell_object, cell_room;
    uint32_t *order, *rank;               ///< objects by their nearest depth, and back
    uint32_t *mark, *near, *spare, stamp; ///< for hidden_neighbours
    struct span_list spans;
    // The thesis' lists of one edge.
    struct hidden_crossing *crossings;
    uint32_t crossing_room, *crossing_order, *crossing_spare;
    uint8_t *edge_done;
    int32_t *invisible; ///< of the vertices of an object
    uint32_t front_faces, extreme_total;
    uint32_t shadow_tests; ///< of the last hidden_clip: edges clipped, by an object each
    size_t workspace_bytes;
};

enum hidden_status { HIDDEN_OK = 0, HIDDEN_ERROR_WORKSPACE = -1 };

/// Bytes of workspace for a scene, aligned to 8: about 1.9 KiB a cube.
size_t hidden_workspace_bytes(const struct shape_set *set);

enum hidden_status hidden_open(struct hidden *hidden, const struct shape_set *set, void *workspace,
                               size_t workspace_bytes) MUST_CHECK;

/// Steps 2 to 4: faces and edges as the eye sees them, projected, with windows and shadows.
void hidden_look(struct hidden *hidden, const struct hidden_camera *camera);

/// Every visible part of every drawn edge, by object, edge and place.
/// Cost: O(n log n) and what a cell of the picture holds of objects in front of each other; in
///       lattices up to 4,096 cubes measured n^1.2 (docs/levine.md).
void hidden_clip(struct hidden *hidden, const struct hidden_sink *sink);

/// The same by the thesis' pipeline (steps 1, 5 and 6). counters: NULL, or what to add to; then
/// each pair of objects is looked up, else only those whose windows meet.
void hidden_levine(struct hidden *hidden, const struct separate *separate,
                   const struct hidden_sink *sink, struct hidden_counters *counters);

/// For the methods: objects whose windows meet that of this one and that can be nearer than some of
/// it, the nearest first, without itself. In hidden->near.
uint32_t hidden_neighbours(struct hidden *hidden, uint32_t object);
/// The part of an edge that is behind the plane of the eye, as the first of the hidden ones. False:
/// all of it.
bool hidden_begin_edge(struct hidden *hidden, const struct shape_edge *edge);
/// Gives the sink what hidden->spans leave of an edge.
void hidden_end_edge(const struct hidden *hidden, uint32_t object, uint32_t edge,
                     const struct hidden_sink *sink);
/// Adds what an object hides of an edge to hidden->spans. False: nothing.
bool hidden_add_shadow(struct hidden *hidden, uint32_t object, const struct shape_edge *edge);
/// The window of an edge; everything, if it reaches the plane of the eye.
struct hidden_window hidden_edge_window(const struct hidden *hidden, const struct shape_edge *edge);
static inline bool hidden_windows_meet(const struct hidden_window *a,
                                       const struct hidden_window *b) {
    return a->left <= b->right && b->left <= a->right && a->low <= b->high && b->low <= a->high;
}

#endif

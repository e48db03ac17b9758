/// Regular projections: directions from which nothing lines up by accident.
///
/// Each problem names a degeneracy of a projection. `decide` tests the data as they stand,
/// `compute` finds a direction (or axes) without it, `optimize` the direction that may be off by
/// the largest angle before it appears. All decisions, and all directions of `compute`, are exact
/// integers.
///
/// What is forbidden is either a direction (the line through two points, a segment), or all
/// directions of a plane: a great circle of the sphere of directions, given by its normal.
///
/// Source: Gomez, Ramaswami, Toussaint 1996, as corrected in docs/regular.md.
#ifndef REGULAR_REGULAR_H
#define REGULAR_REGULAR_H

#include "fixed/must_check.h"
#include "fixed/vec3.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Coordinates are within +-2^20: differences have 21 bits, normals of planes 43.
#define REGULAR_COORDINATE_MAX (INT32_C(1) << 20)
#define REGULAR_WEIGHT_MAX     (UINT32_C(1) << 20)

/// The conflicts of each, when projected along z, in the plane along y. An item is a point, of
/// SEGMENTS two points, of FACES three.
enum regular_problem {
    REGULAR_POINTS2_LINE,       ///< two points have the same x; z is 0
    REGULAR_POINTS3_LINE,       ///< two points have the same x and y
    REGULAR_POINTS3_X,          ///< two points have the same x: projected ONTO the x axis
    REGULAR_POINTS3_XY,         ///< two points have the same x, or the same y
    REGULAR_POINTS3_XYZ,        ///< the same x, or y, or z
    REGULAR_POINTS3_PLANE,      ///< two points coincide, or three lie on one line
    REGULAR_POINTS3_COCIRCULAR, ///< two points coincide, or four lie on one circle
    REGULAR_SEGMENTS2_VERTICAL, ///< a segment becomes a point; z is 0
    REGULAR_SEGMENTS3_VERTICAL, ///< a segment becomes a point
    REGULAR_SEGMENTS3_PLANE,    ///< a segment becomes a point, or two lie on one line
    REGULAR_FACES_VERTICAL,     ///< a face becomes a line
    REGULAR_PROBLEMS            ///< how many there are
};

enum regular_status {
    REGULAR_OK = 0,
    /// compute, optimize: no regular projection exists; result->conflict tells why not: three
    /// points on one line, two segments on one line.
    REGULAR_NONE = -1,
    /// A coordinate is beyond REGULAR_COORDINATE_MAX, or z is not 0 in the plane, or a weight is 0
    /// or beyond REGULAR_WEIGHT_MAX: conflict has the item.
    REGULAR_ERROR_RANGE = -2,
    REGULAR_ERROR_REPEATED = -3, ///< two points of a point problem are equal: conflict has both
    /// A segment without length, or a face whose points are on one line: conflict has the item.
    REGULAR_ERROR_DEGENERATE = -4,
    REGULAR_ERROR_COUNT = -5, ///< more items than regular_count_max
    REGULAR_ERROR_WORKSPACE = -6,
    /// POINTS3_COCIRCULAR has no optimize: an open problem.
    REGULAR_ERROR_OPEN = -7
};

struct regular_input {
    enum regular_problem problem;
    const struct vec3 *points; ///< regular_points_of(problem) for each item
    uint32_t count;            ///< of items
};

/// Items, by index: ascending. 1: it is degenerate by itself (a vertical segment or face).
struct regular_conflict {
    uint8_t count;
    uint32_t index[4];
};

struct regular_result {
    bool regular;                     ///< decide: no conflict. compute, optimize: true
    struct regular_conflict conflict; ///< of !regular, REGULAR_NONE and the errors that say so
    /// compute, optimize: not of unit length. The direction to project along; POINTS3_X: the line
    /// to project onto. In the plane z is 0. Not for POINTS3_XY and _XYZ.
    struct vec3_i128 direction;
    /// POINTS3_XY and _XYZ: the new x, y and z axes: orthogonal, of equal length, det > 0.
    struct vec3_i128 rotation[3];
    /// optimize: all directions within this angle (2^64 a turn) of `direction` are regular; of a
    /// rotation, all that turn no axis further. Rounded down.
    uint64_t tolerance_turn64;
    /// The tolerance holds, but something better may exist: POINTS3_XY and _XYZ; and the cylinder
    /// beside segments that share no plane.
    bool tolerance_is_bound;
    /// What it cost: comparisons, products of vectors and the like, the unit of make bench-regular.
    uint64_t operations;
};

enum regular_step { REGULAR_DECIDE, REGULAR_COMPUTE, REGULAR_OPTIMIZE };

/// How. All zero: the best known way.
struct regular_options {
    /// Decisions and widest gaps by buckets (the floor function) instead of sorting. The answers
    /// are the same.
    bool buckets;
    /// POINTS3_PLANE compute: O(n) space and O(n^3) time, instead of O(n^2) expected time.
    bool small;
    /// optimize, where circles are forbidden: as the thinnest anchored cylinder, in space
    /// proportional to the number of circles instead of its square.
    bool cylinder;
    /// optimize, where circles are forbidden: the direction must lie above every forbidden plane,
    /// on the side of +z. REGULAR_NONE if one is vertical: conflict has its items.
    bool above;
    /// POINTS2_LINE optimize: a weight for each point; NULL: all 1. A pair of points
    /// weighs as much as the heavier one; its direction keeps weight * tolerance away.
    const uint32_t *weights;
};

static inline uint32_t regular_points_of(enum regular_problem problem) {
    return problem == REGULAR_FACES_VERTICAL ? 3U : problem >= REGULAR_SEGMENTS2_VERTICAL ? 2U : 1U;
}

static inline bool regular_is_planar(enum regular_problem problem) {
    return problem == REGULAR_POINTS2_LINE || problem == REGULAR_SEGMENTS2_VERTICAL;
}

/// The largest number of items that a step takes. options may be NULL.
uint32_t regular_count_max(enum regular_problem problem, enum regular_step step,
                           const struct regular_options *options);

/// Bytes of workspace, aligned to 8, for count items; count must not exceed regular_count_max.
/// docs/regular.md lists them. options may be NULL.
uint64_t regular_workspace_bytes(enum regular_problem problem, enum regular_step step,
                                 uint32_t count, const struct regular_options *options);

/// Is the projection along the axis free of conflicts? result->regular and conflict tell.
/// Cost:     O(n log n) for points, with buckets expected O(n) for coordinates that are spread
///           evenly, but POINTS3_PLANE expected O(n^2) and POINTS3_COCIRCULAR O(n^3); segments and
///           faces O(n), SEGMENTS3_PLANE O(n log n) (make bench-regular). No allocation, no
///           recursion.
/// Accuracy: exact (tests/property/regular_decide.c: all pairs, triples and quadruples).
enum regular_status regular_decide(const struct regular_input *input,
                                   const struct regular_options *options, void *workspace,
                                   size_t workspace_bytes,
                                   struct regular_result *result) MUST_CHECK;

/// A regular direction, or axes; that of `decide` if it is regular.
/// Cost:     O(n log n) for points, but POINTS3_PLANE expected O(n^2) (options->small: O(n^3)
///           without hashing; both in O(n) space) and POINTS3_COCIRCULAR expected O(n^3) for each
///           direction tried, almost always one or two; segments and faces O(n), SEGMENTS3_PLANE
///           O(n^2) (make bench-regular).
/// Accuracy: exact (tests/property/regular_compute.c: the definitions, in integers of any size).
enum regular_status regular_compute(const struct regular_input *input,
                                    const struct regular_options *options, void *workspace,
                                    size_t workspace_bytes,
                                    struct regular_result *result) MUST_CHECK;

/// A direction of largest tolerance.
/// Cost:     O(m log m) for m forbidden directions: n^2 / 2 for points, n segments. O(m^2) time and
///           space for m forbidden circles: n^2 / 2 for POINTS3_X, n^3 / 6 for POINTS3_PLANE, up to
///           n^2 / 2 for SEGMENTS3_PLANE, n faces. options->cylinder: O(m^2 log m) expected, O(m)
///           space. POINTS3_XY and _XYZ: a fixed search of O(n^2) a step; see tolerance_is_bound.
///           Growth and reach: make bench-regular. Up to 20 KB of stack, where two discs are
///           compared exactly; decide and compute need 2 KB.
/// Accuracy: which gap or disc is the largest is decided on exact integers (regular/disc.h), but
///           with weights, beside segments that share no plane (regular/lone.h) and by the cylinder
///           (regular/cylinder.h) to about 2^-45. The direction is within 2 nrad of the centre, and
///           the tolerance below that of the direction as returned by less than 1e-12 rad
///           (tests/property/regular_optimize.c, regular_variants.c).
enum regular_status regular_optimize(const struct regular_input *input,
                                     const struct regular_options *options, void *workspace,
                                     size_t workspace_bytes,
                                     struct regular_result *result) MUST_CHECK;

#endif

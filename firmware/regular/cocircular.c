#include "regular/cocircular.h"

#include "regular/primitive.h"

/// For directions with components of at most 8 bits.
struct view {
    struct vec3 direction;
    int64_t norm2; ///< below 2^17.6
};

static int64_t dot(struct vec3 a, struct vec3 b) {
    return vec3_dot_unit(a, b);
}

/// |v|^2 times the dot product of the projections: by Cauchy and Schwarz at most
/// |v|^2 |a| |b| < 2^(17.6 + 43.6), and so are its two parts.
static int64_t dot_seen(const struct view *view, struct vec3 a, struct vec3 b) {
    return view->norm2 * dot(a, b) - dot(view->direction, a) * dot(view->direction, b);
}

/// |v| times the cross product of the projections: below 2^(8.8 + 43.6).
static int64_t cross_seen(const struct view *view, struct vec3 a, struct vec3 b) {
    const struct vec3_i64 cross = vec3_cross(a, b);
    return cross.x * view->direction.x + cross.y * view->direction.y + cross.z * view->direction.z;
}

static void tell(struct regular_conflict *conflict, uint8_t count, uint32_t i, uint32_t j,
                 uint32_t k, uint32_t l) {
    *conflict = (struct regular_conflict){count, {i, j, k, l}};
}

/// k sees the chord from i to j under an angle whose cotangent is dot / cross, but for the factor
/// |v|: on one circle it is the same, on any other one through both ends it differs.
/// All circles through i and j, with third and fourth points behind j. False: a conflict.
static bool chord_free(const struct vec3 *points, uint32_t count, const struct view *view,
                       bool strict, uint32_t i, uint32_t j, struct line_table *lines,
                       struct regular_conflict *conflict) {
    line_table_next_round(lines);
    for (uint32_t k = j + 1U; k < count; k++) {
        const struct vec3 a = primitive_between(points[k], points[i]);
        const struct vec3 b = primitive_between(points[k], points[j]);
        const int64_t sine = cross_seen(view, a, b);
        if (sine == 0) {
            const struct vec3_i64 plane = vec3_cross(a, b);
            if (strict && !primitive_is_zero(plane)) {
                tell(conflict, 3, i, j, k, 0);
                return false;
            }
            continue; // no circle goes through three points of a line
        }
        const uint32_t same = line_table_enter(
            lines, k, primitive_vec3_i64((struct vec3_i64){dot_seen(view, a, b), sine, 0}));
        if (same != LINE_TABLE_NONE) {
            tell(conflict, 4, i, j, same, k);
            return false;
        }
    }
    return true;
}

bool cocircular_none(const struct vec3 *points, uint32_t count, struct vec3 direction, bool strict,
                     struct line_table *lines, struct regular_conflict *conflict) {
    const struct view view = {direction, dot(direction, direction)};
    line_table_start(lines);
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i + 1U; j < count; j++) {
            const struct vec3_i64 cross =
                vec3_cross(primitive_between(points[i], points[j]), direction);
            if (primitive_is_zero(cross)) {
                tell(conflict, 2, i, j, 0, 0);
                return false;
            }
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i + 1U; j < count; j++) {
            if (!chord_free(points, count, &view, strict, i, j, lines, conflict)) {
                return false;
            }
        }
    }
    return true;
}

#include "regular/circles.h"

#include "regular/primitive.h"
#include "regular/steps.h"

static bool each_pair_of_points(const struct regular_input *input, circles_visit *visit,
                                void *context) {
    for (uint32_t i = 0; i < input->count; i++) {
        for (uint32_t j = i + 1U; j < input->count; j++) {
            const uint32_t items[2] = {i, j};
            const struct vec3 d = primitive_between(input->points[i], input->points[j]);
            if (!visit(context, vec3_widen(d), 2, items)) {
                return true;
            }
        }
    }
    return true;
}

static bool each_triple(const struct regular_input *input, circles_visit *visit, void *context,
                        struct regular_conflict *conflict) {
    const struct vec3 *const points = input->points;
    for (uint32_t i = 0; i < input->count; i++) {
        for (uint32_t j = i + 1U; j < input->count; j++) {
            for (uint32_t k = j + 1U; k < input->count; k++) {
                const uint32_t items[3] = {i, j, k};
                const struct vec3_i64 normal = steps_normal(points[i], points[j], points[k]);
                if (primitive_is_zero(normal)) {
                    *conflict = (struct regular_conflict){3, {i, j, k, 0}};
                    return false;
                }
                if (!visit(context, normal, 3, items)) {
                    return true;
                }
            }
        }
    }
    return true;
}

/// The plane of two segments: by their directions, or from one to the other where they are
/// parallel. Returns: whether they are in one plane; the normal is zero if they are on one line.
static bool common_plane(const struct vec3 *a, const struct vec3 *b, struct vec3_i64 *normal) {
    const struct vec3 u = primitive_between(a[0], a[1]), v = primitive_between(b[0], b[1]);
    const struct vec3 across = primitive_between(a[0], b[0]);
    *normal = vec3_cross(u, v);
    if (primitive_is_zero(*normal)) {
        *normal = vec3_cross(u, across);
        return true;
    }
    return i128_sign(vec3_i64_dot_vec3(*normal, across)) == 0;
}

static bool each_pair_of_segments(const struct regular_input *input, circles_visit *visit,
                                  void *context, struct regular_conflict *conflict) {
    for (uint32_t i = 0; i < input->count; i++) {
        for (uint32_t j = i + 1U; j < input->count; j++) {
            struct vec3_i64 normal;
            if (!common_plane(input->points + 2U * (size_t)i, input->points + 2U * (size_t)j,
                              &normal)) {
                continue;
            }
            if (primitive_is_zero(normal)) {
                *conflict = (struct regular_conflict){2, {i, j, 0, 0}};
                return false;
            }
            const uint32_t items[2] = {i, j};
            if (!visit(context, normal, 2, items)) {
                return true;
            }
        }
    }
    return true;
}

static bool each_face(const struct regular_input *input, circles_visit *visit, void *context) {
    for (uint32_t i = 0; i < input->count; i++) {
        const struct vec3 *const face = input->points + 3U * (size_t)i;
        if (!visit(context, steps_normal(face[0], face[1], face[2]), 1, &i)) {
            return true;
        }
    }
    return true;
}

bool circles_each(const struct regular_input *input, circles_visit *visit, void *context,
                  struct regular_conflict *conflict, uint64_t *planes) {
    const uint64_t n = input->count;
    *planes = input->problem == REGULAR_FACES_VERTICAL  ? n
              : input->problem == REGULAR_POINTS3_PLANE ? n * (n - (n != 0U)) / 2U * (n - 2U) / 3U
                                                        : n * (n - (n != 0U)) / 2U;
    switch (input->problem) {
    case REGULAR_POINTS3_X:
        return each_pair_of_points(input, visit, context);
    case REGULAR_POINTS3_PLANE:
        return each_triple(input, visit, context, conflict);
    case REGULAR_SEGMENTS3_PLANE:
        return each_pair_of_segments(input, visit, context, conflict);
    default:
        return each_face(input, visit, context);
    }
}

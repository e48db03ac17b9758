/// What the papers print of the hull (1985, section 3) and the pyramid (1982), run as printed, on
/// the sets on which it fails; and ours on the same sets. docs/geometry.md, "Where the papers err",
/// names the tests here. All in exact integers: coordinates are small.
#include "check.h"

#include "sphere/hull.h"
#include "sphere/pyramid.h"

#include <math.h>
#include <stdio.h>

enum { MOST = 12 };

static uint64_t seed = 19850301;
static uint64_t workspace[PYRAMID_WORKSPACE_BYTES(MOST) / 8U + HULL_WORKSPACE_BYTES(MOST)];

static int64_t det(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i64 n = vec3_cross(b, c);
    return a.x * n.x + a.y * n.y + a.z * n.z;
}

static int32_t between(int32_t low, int32_t high) {
    const uint64_t span = (uint64_t)(high - low) + 1U;
    return low + (int32_t)((check_random(&seed) >> 32) * span >> 32);
}

/// A list of points; none: found to be not hemispherical.
struct list {
    unsigned count;
    struct vec3 at[2 * MOST];
};

static bool has(const struct list *list, struct vec3 point) {
    for (unsigned i = 0; i < list->count; i++) {
        if (vec3_equal(list->at[i], point)) {
            return true;
        }
    }
    return false;
}

static struct list ours(const struct vec3 *points, uint32_t count) {
    struct hull_result result;
    struct list list = {0};
    if (hull_spherical(points, count, workspace, sizeof workspace, &result) == HULL_OK) {
        for (uint32_t i = 0; i < result.vertex_count; i++) {
            list.at[list.count++] = points[result.vertices[i]];
        }
    }
    return list;
}

// ---------------------------------------------------------------- Graham's scan, as printed

/// "to the left of the segment from p to q"
static bool is_left(struct vec3 r, struct vec3 p, struct vec3 q) {
    return det(p, q, r) > 0;
}

/// p_2 to p_n are in clockwise order. repaired: what one might take the branch that loses a vertex
/// for, the three points of the new triangle in order.
static struct list hull_as_printed(const struct vec3 *p, unsigned n, bool repaired) {
    struct vec3 q[4 * MOST];
    unsigned j = 0, k = 1;
    q[0] = p[0];
    q[1] = p[1];
    for (unsigned i = 2; i < n; i++) {
        const struct vec3 temp = q[k];
        while (k > j && is_left(p[i], q[k - 1], q[k])) {
            k--;
        }
        if (k == j) {
            if (is_left(p[i], temp, q[j])) {
                return (struct list){0};
            }
            const struct vec3 first = q[j];
            q[j] = repaired ? temp : first;
            q[j + 1] = repaired ? first : p[i];
            q[j + 2] = repaired ? p[i] : temp;
            k = j + 2;
        } else {
            q[++k] = p[i];
            while (j + 1 < k && is_left(p[i], q[j], q[j + 1])) {
                j++;
            }
        }
    }
    struct list list = {0};
    for (unsigned i = j; i <= k; i++) {
        list.at[list.count++] = q[i];
    }
    return list;
}

/// Clockwise about the first point, as seen from outside, from a random one on.
static void sort_about_first(struct vec3 *p, unsigned n) {
    double angle[MOST] = {0};
    const double length = sqrt((double)vec3_norm2(p[0]));
    const double a[3] = {p[0].x / length, p[0].y / length, p[0].z / length};
    const double flat = hypot(a[0], a[1]) > 0.1 ? hypot(a[0], a[1]) : 0.0;
    const double r[3] = {flat > 0.0 ? -a[1] / flat : 1.0, flat > 0.0 ? a[0] / flat : 0.0, 0.0};
    const double u[3] = {a[1] * r[2] - a[2] * r[1], a[2] * r[0] - a[0] * r[2],
                         a[0] * r[1] - a[1] * r[0]};
    const double start = between(0, 1000) * 0.00628;
    for (unsigned i = 1; i < n; i++) {
        const double x = r[0] * p[i].x + r[1] * p[i].y + r[2] * p[i].z,
                     y = u[0] * p[i].x + u[1] * p[i].y + u[2] * p[i].z;
        angle[i] = fmod(start - atan2(y, x) + 13.0, 6.283185307179586);
    }
    for (unsigned i = 2; i < n; i++) {
        for (unsigned k = i; k > 1 && angle[k] < angle[k - 1]; k--) {
            const double t = angle[k];
            const struct vec3 v = p[k];
            angle[k] = angle[k - 1];
            p[k] = p[k - 1];
            angle[k - 1] = t;
            p[k - 1] = v;
        }
    }
}

/// The order's start is not said, and where p_1 is extreme it may lose a vertex.
static void start_of_the_order(void) {
    const struct vec3 square[] = {{-1, 0, 1}, {0, 0, 1}, {-1, 1, 1}, {0, 1, 1}};
    const struct list printed = hull_as_printed(square, 4, false);
    CHECK_EQ(printed.count, 3);
    CHECK(!has(&printed, square[1]));
    CHECK_EQ(ours(square, 4).count, 4);
    unsigned lost = 0, lost_repaired = 0;
    for (unsigned t = 0; t < 4000U; t++) {
        struct vec3 p[4];
        for (unsigned i = 0; i < 4U; i++) {
            p[i] = vec3(between(-50, 50), between(-50, 50), 400);
        }
        sort_about_first(p, 4);
        const unsigned right = ours(p, 4).count;
        lost += hull_as_printed(p, 4, false).count != right;
        lost_repaired += hull_as_printed(p, 4, true).count != right;
    }
    check_note("of 4,000 sets of four, wrong as printed", lost);
    check_note("with the branch put in order", lost_repaired);
    CHECK(lost > 600U && lost_repaired > 300U);
}

/// Points right of the closing edge are appended and never removed. The proof of correctness takes
/// the list for the hull of all points so far, which it then isn't.
static void points_inside_the_closing_edge(void) {
    const struct vec3 five[] = {{0, -1, 1}, {1, 1, 1}, {-2, 0, 1}, {0, -2, 1}, {-1, 0, 1}};
    unsigned wrong = 0, kept = 0;
    for (unsigned start = 0; start < 100U; start++) {
        struct vec3 p[5];
        for (unsigned i = 0; i < 5U; i++) {
            p[i] = five[i];
        }
        sort_about_first(p, 5);
        const struct list printed = hull_as_printed(p, 5, false);
        wrong += printed.count != 3U;
        kept += has(&printed, five[4]);
        CHECK_EQ(ours(p, 5).count, 3);
    }
    CHECK(wrong > 0U && kept > 0U);
    unsigned inside = 0, failed = 0;
    for (unsigned t = 0; t < 4000U; t++) {
        struct vec3 p[8];
        for (unsigned i = 0; i < 8U; i++) {
            p[i] = vec3(between(-300, 300), between(-300, 300), 400);
        }
        sort_about_first(p, 8);
        const struct list right = ours(p, 8);
        if (!has(&right, p[0])) {
            inside++;
            failed += hull_as_printed(p, 8, false).count != right.count;
        }
    }
    check_note("sets of eight whose first point is inside", inside);
    check_note("of these wrong as printed", failed);
    CHECK(failed * 10U > inside);
}

static void closed_half_spheres_are_accepted(void) {
    const struct vec3 flat[] = {{1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    const struct vec3 pair[] = {{-1, -2, 0}, {-1, 1, 0}, {1, -1, 0}};
    CHECK(hull_as_printed(flat, 3, false).count > 0U);
    CHECK(hull_as_printed(pair, 3, false).count > 0U);
    CHECK_EQ(ours(flat, 3).count, 0);
    CHECK_EQ(ours(pair, 3).count, 0);
}

static void collinear_and_repeated_points_are_kept(void) {
    const struct vec3 arc[] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const struct vec3 twice[] = {{0, 0, 1}, {0, 1, 1}, {0, 2, 2}, {1, 0, 1}};
    CHECK_EQ(hull_as_printed(arc, 3, false).count, 3);
    CHECK_EQ(ours(arc, 3).count, 2);
    CHECK_EQ(hull_as_printed(twice, 4, false).count, 4);
    CHECK_EQ(ours(twice, 4).count, 3);
    CHECK_EQ(ours(arc, 1).count, 1); // as printed, p_2 is read all the same
}

// ---------------------------------------------------------------- the pyramid, as printed

/// The edges after all points: the first three begin, in the order given. Faces with a negative
/// product give way to the new edge, and nothing else does.
static struct list pyramid_as_printed(const struct vec3 *points, unsigned count) {
    struct list edges = {3, {points[0], points[1], points[2]}};
    for (unsigned i = 3; i < count; i++) {
        unsigned negative = 0, first = 0;
        bool below[2 * MOST];
        for (unsigned e = 0; e < edges.count; e++) {
            below[e] = det(points[i], edges.at[e], edges.at[(e + 1U) % edges.count]) < 0;
            negative += below[e];
        }
        if (negative == 0U) {
            continue;
        }
        if (negative == edges.count) {
            return (struct list){0};
        }
        while (!below[first] || below[(first + edges.count - 1U) % edges.count]) {
            first++;
        }
        struct list next = {1, {points[i]}};
        for (unsigned e = 0; e <= edges.count - negative; e++) { // from the run's end round to it
            next.at[next.count++] = edges.at[(first + negative + e) % edges.count];
        }
        edges = next;
    }
    return edges;
}

static unsigned our_edges(const struct vec3 *points, uint32_t count) {
    struct pyramid_result result;
    return pyramid_narrowest(points, count, workspace, sizeof workspace, &result) == CONE_OK
               ? result.edges
               : 0U;
}

/// "If all the scalar products are negative": those that are zero count, too.
static void opposite_edge_is_accepted(void) {
    const struct vec3 points[] = {{3, 1, 4}, {-1, 5, 9}, {2, -6, 5}, {-2, -6, -13}};
    CHECK(det(points[0], points[1], points[2]) > 0);
    CHECK(pyramid_as_printed(points, 4).count > 0U);
    CHECK_EQ(our_edges(points, 4), 0);
}

/// A face in one plane with the new point stays, and so does an edge between two others.
static void edges_between_others_stay(void) {
    const struct vec3 points[] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {2, 0, 1}};
    const struct list printed = pyramid_as_printed(points, 4);
    CHECK_EQ(printed.count, 4);
    CHECK(has(&printed, points[1]));
    CHECK_EQ(our_edges(points, 4), 3);
    unsigned more = 0, missed = 0, compared = 0;
    for (unsigned t = 0; t < 30000U; t++) {
        struct vec3 p[7];
        for (unsigned i = 0; i < 7U; i++) {
            do {
                p[i] = vec3(between(-2, 2), between(-2, 2), between(-1, 3));
            } while (vec3_is_zero(p[i]));
        }
        if (det(p[0], p[1], p[2]) > 0) {
            const struct list as_printed = pyramid_as_printed(p, 7), right = ours(p, 7);
            compared++;
            missed += as_printed.count > 0U && right.count == 0U;
            more += right.count > 0U && as_printed.count > right.count;
            if (right.count > 2U) {
                CHECK_EQ(our_edges(p, 7), right.count);
            }
        }
    }
    check_note("sets of seven on a small grid", compared);
    check_note("infeasible, accepted as printed", missed);
    check_note("with edges to spare as printed", more);
    CHECK(missed > 100U && more > 100U);
}

/// "Any three non-coplanar": they have to be in counter-clockwise order as seen from outside, which
/// is clockwise from behind the apex. Else all normals point outward, and what is inside the
/// pyramid is taken for infeasible.
static void order_of_the_first_three(void) {
    const struct vec3 points[] = {{1, 0, 1}, {-1, -1, 1}, {-1, 1, 1}, {0, 0, 1}};
    CHECK(det(points[0], points[1], points[2]) < 0);
    CHECK_EQ(pyramid_as_printed(points, 4).count, 0);
    CHECK_EQ(our_edges(points, 4), 3);
    const struct vec3 n = {0, 0, 1}; // inside: ahead of V1 x V2 where V1, V2, V3 are in order
    CHECK(det(n, points[1], points[0]) > 0);
}

/// No three span a pyramid: the arc's ends are the answer.
static void all_in_one_plane(void) {
    const struct vec3 points[] = {{1, 1, 0}, {1, 0, 0}, {3, 1, 0}, {0, 1, 0}};
    struct pyramid_result result;
    CHECK_EQ(pyramid_narrowest(points, 4, workspace, sizeof workspace, &result), CONE_OK);
    CHECK(vec3_equal(result.cone.axis_q30, vec3_normalise(points[0])));
    CHECK_EQ(result.cone.support[0], 1);
    CHECK_EQ(result.cone.support[1], 3);
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(start_of_the_order);
    TEST(points_inside_the_closing_edge);
    TEST(closed_half_spheres_are_accepted);
    TEST(collinear_and_repeated_points_are_kept);
    TEST(opposite_edge_is_accepted);
    TEST(edges_between_others_stay);
    TEST(order_of_the_first_three);
    TEST(all_in_one_plane);
    return check_finish();
}

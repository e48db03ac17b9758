/// What the papers print of the smallest circle (1985, section 4) and of pictures (1982), run as
/// printed on the sets on which it fails; and ours on the same sets. docs/geometry.md, "Where the
/// papers err", names the tests here. What is printed runs in doubles, on sets well apart.
#include "check.h"
#include "property/support/exact_roots.h"
#include "property/support/methods.h"

#include "aim/orient.h"
#include "sphere/hull.h"
#include "sphere/min_norm.h"
#include "sphere/voronoi.h"

#include <math.h>
#include <stdio.h>

enum { MOST = 40 };

static uint64_t seed = 19850403;
static uint64_t workspace[VORONOI_WORKSPACE_BYTES(MOST) / 8U + HULL_WORKSPACE_BYTES(MOST)];

struct unit {
    double x, y, z;
};

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

static double dot(struct unit a, struct unit b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static struct unit cross(struct unit a, struct unit b) {
    return (struct unit){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static struct unit plus(struct unit a, double of_b, struct unit b) {
    return (struct unit){a.x + of_b * b.x, a.y + of_b * b.y, a.z + of_b * b.z};
}

static struct unit normalised(struct unit a) {
    const double scale = 1.0 / sqrt(dot(a, a));
    return (struct unit){a.x * scale, a.y * scale, a.z * scale};
}

static struct unit unit_of(struct vec3 v) {
    return normalised((struct unit){v.x, v.y, v.z});
}

static double apart(struct unit a, struct unit b) {
    const struct unit c = cross(a, b);
    return atan2(sqrt(dot(c, c)), dot(a, b));
}

/// Uniform on a cap of this radius about a random direction that stays the same in a set.
static void draw(struct vec3 *points, unsigned count, double radius) {
    const double up = 2.0 * uniform() - 1.0, turn = 6.283185307179586 * uniform(),
                 out = sqrt(1.0 - up * up);
    const struct unit z = {out * cos(turn), out * sin(turn), up};
    const struct unit x =
        normalised(cross(z, fabs(up) < 0.9 ? (struct unit){0, 0, 1} : (struct unit){1, 0, 0}));
    const struct unit y = cross(z, x);
    for (unsigned i = 0; i < count; i++) {
        const double c = 1.0 - uniform() * (1.0 - cos(radius)), s = sqrt(1.0 - c * c),
                     a = 6.283185307179586 * uniform();
        const struct unit p =
            plus(plus((struct unit){c * z.x, c * z.y, c * z.z}, s * cos(a), x), s * sin(a), y);
        points[i] = vec3((int32_t)lround(p.x * 0x1p30), (int32_t)lround(p.y * 0x1p30),
                         (int32_t)lround(p.z * 0x1p30));
    }
}

// ---------------------------------------------------------------- the shrinking circle

/// What is run as printed; all else as corrected.
struct printed {
    bool maximum;      ///< step 4: the maximum of 1 and the root
    bool minimum;      ///< step 4 as one might mean it: the minimum
    bool stop_at_one;  ///< step 3 also where x_0 is the only contact
    bool least_of_all; ///< step 5: the least and greatest of all contacts
    bool middle;       ///< eq (11) as in the proof of Lemma 2: from c to the middle of the two
};

enum outcome { SMALLEST, OTHER_CIRCLE, ENDLESS };

struct shrinking {
    const struct printed *printed;
    unsigned k, cw, ccw;
    struct unit x[MOST + 1], c;
};

static struct unit toward(const struct shrinking *s) {
    const struct unit sum = plus(s->x[s->cw], 1.0, s->x[s->ccw]);
    return plus(s->printed->middle ? normalised(sum) : sum, -1.0, s->c);
}

static double alpha_of(const struct shrinking *s, struct unit q, unsigned i) {
    const struct unit edge = plus(s->x[s->cw], -1.0, s->x[i]);
    const double root = -dot(s->c, edge) / dot(q, edge);
    if (s->printed->maximum) {
        return fmax(1.0, root);
    }
    if (s->printed->minimum) {
        return fmin(1.0, root);
    }
    return root >= 0.0 && root < 1.0 ? root : 1.0;
}

/// The new contacts, of those on the new circle. det(c, q, x) > 0: left of q.
static void choose_contacts(struct shrinking *s, struct unit before, struct unit q) {
    const double r = apart(s->c, s->x[s->cw]);
    const unsigned cw = s->cw, ccw = s->ccw;
    const bool all = s->printed->least_of_all;
    bool found = false;
    for (unsigned i = all ? 0U : ccw + 1U; i < (all ? s->k : cw); i++) {
        if (fabs(apart(s->c, s->x[i]) - r) > 1e-11) {
            continue;
        }
        const double left = dot(cross(before, q), s->x[i]);
        if (left > 1e-12 && !found) {
            s->cw = i;
            found = true;
        } else if (left < -1e-12 || (!all && left <= 1e-12)) { // behind counts as right
            s->ccw = i;
        }
    }
}

/// corners: of the hull, clockwise. *wide: whether the first circle is larger than a great one.
static enum outcome shrink_as_printed(const struct vec3 *corners, unsigned k, unsigned first,
                                      const struct printed *printed, double optimum, bool *wide) {
    struct shrinking s = {.printed = printed, .k = k, .cw = k, .ccw = 0};
    unsigned farthest = 0;
    s.c = unit_of(corners[first]);
    for (unsigned i = 0; i < k; i++) {
        if (apart(s.c, unit_of(corners[i])) > apart(s.c, unit_of(corners[farthest]))) {
            farthest = i;
        }
    }
    for (unsigned i = 0; i <= k; i++) {
        s.x[i] = unit_of(corners[(farthest + i) % k]);
    }
    *wide = apart(s.c, s.x[0]) > 1.5707963267948966;
    for (unsigned round = 0; round < 4U * k; round++) {
        const bool is_one = s.cw == k && s.ccw == 0U;
        if (!(is_one && !printed->stop_at_one) &&
            !(dot(s.c, cross(s.x[s.cw], s.x[s.ccw])) < -1e-12)) {
            double r = 0.0; // does it hold all, and is it the smallest?
            for (unsigned i = 0; i < k; i++) {
                r = fmax(r, apart(s.c, s.x[i]));
            }
            return fabs(r - optimum) < 1e-8 ? SMALLEST : OTHER_CIRCLE;
        }
        const struct unit q = toward(&s), before = s.c;
        double alpha = INFINITY;
        for (unsigned i = s.ccw + 1U; i < s.cw; i++) {
            alpha = fmin(alpha, alpha_of(&s, q, i));
        }
        alpha = isinf(alpha) ? 1.0 : alpha;
        s.c = normalised(plus(s.c, alpha, q));
        choose_contacts(&s, before, q);
        if (s.cw <= s.ccw) {
            return OTHER_CIRCLE; // "In all cases cw > ccw"
        }
    }
    return ENDLESS;
}

static const struct printed corrected = {0}, by_maximum = {.maximum = true},
                            by_minimum = {.minimum = true}, one_contact = {.stop_at_one = true},
                            least = {.least_of_all = true}, to_middle = {.middle = true};

static double optimum_of(const struct vec3 *points, unsigned count) {
    struct cone_result result;
    CHECK_EQ(methods[METHOD_SHRINK].solve(points, count, &result), CONE_OK);
    CHECK(exact_holds_cone(points, count, result.support, result.support_count));
    return ldexp((double)result.half_angle_turn64, -64) * 6.283185307179586;
}

static void shrinking(void) {
    const struct printed *const variants[] = {&by_maximum, &by_minimum, &one_contact, &least};
    unsigned sets = 0, wide_sets = 0, wrong[4] = {0}, away[2] = {0};
    for (unsigned t = 0; t < 3000U && check_clean(); t++) {
        struct vec3 points[MOST], corners[MOST];
        const unsigned count = 4U + (unsigned)(uniform() * 30.0);
        struct hull_result hull;
        draw(points, count, 0.05 + 1.35 * uniform());
        if (hull_spherical(points, count, workspace, sizeof workspace, &hull) != HULL_OK ||
            hull.vertex_count < 3U) {
            continue;
        }
        for (unsigned i = 0; i < hull.vertex_count; i++) {
            corners[i] = points[hull.vertices[i]];
        }
        const unsigned k = hull.vertex_count, first = (unsigned)(uniform() * k);
        const double optimum = optimum_of(points, count);
        bool wide;
        away[0] += shrink_as_printed(corners, k, first, &corrected, optimum, &wide) != SMALLEST;
        away[1] += shrink_as_printed(corners, k, first, &to_middle, optimum, &wide) != SMALLEST;
        for (unsigned v = 0; v < 4U; v++) {
            wrong[v] +=
                shrink_as_printed(corners, k, first, variants[v], optimum, &wide) != SMALLEST;
        }
        wide_sets += wide;
        sets++;
    }
    check_note("sets", sets);
    check_note("first circle larger than a great one", wide_sets);
    check_note("wrong by the maximum of 1 and the root", wrong[0]);
    check_note("wrong by the minimum", wrong[1]);
    check_note("wrong by step 3 with one contact", wrong[2]);
    check_note("wrong by the least of all contacts", wrong[3]);
    check_note("wrong as corrected", away[0]);
    CHECK(wrong[0] > sets / 2U && wrong[1] > sets / 100U && wrong[2] > sets / 2U &&
          wrong[3] > sets / 20U && wide_sets > 100U);
    CHECK_EQ(away[0], 0); // also where the first circle is larger than a great one
    CHECK_EQ(away[1], 0); // eq (11) points where the proof's q does, but for a length
}

// ---------------------------------------------------------------- separable sets

static struct voronoi_result diagram_of(const struct vec3 *points, unsigned count) {
    const struct voronoi_options closest = {.closest = true};
    struct voronoi_result result;
    CHECK_EQ(voronoi_diagram(points, count, &closest, workspace, sizeof workspace, &result),
             VORONOI_OK);
    return result;
}

/// How many closed curves part the regions of X from those of Y: connected pieces of the edges
/// between them.
static unsigned curves(const struct vec3 *points, unsigned count, const bool *is_x) {
    const struct voronoi_result result = diagram_of(points, count);
    uint32_t root[2 * MOST];
    unsigned pieces = 0;
    bool on_curve[2 * MOST] = {false};
    for (uint32_t v = 0; v < result.vertex_count; v++) {
        root[v] = v;
    }
    for (uint32_t e = 0; e < result.edge_count; e++) {
        const struct voronoi_edge edge = result.edges[e];
        if (is_x[edge.site[0]] != is_x[edge.site[1]]) {
            const uint32_t from = root[edge.vertex[0]], to = root[edge.vertex[1]];
            on_curve[edge.vertex[0]] = on_curve[edge.vertex[1]] = true;
            for (uint32_t v = 0; v < result.vertex_count; v++) {
                root[v] = root[v] == from ? to : root[v];
            }
        }
    }
    for (uint32_t v = 0; v < result.vertex_count; v++) {
        pieces += on_curve[v] && root[v] == v;
    }
    return pieces;
}

/// P is one closed curve where a great circle parts X from Y; that both are hemispherical is not
/// enough.
static void separable_not_hemispherical(void) {
    unsigned several = 0;
    for (unsigned t = 0; t < 600U && check_clean(); t++) {
        struct vec3 points[20], plane[1];
        bool is_x[20];
        draw(points, 20, 3.14);
        draw(plane, 1, 3.14);
        unsigned of_x = 0;
        for (unsigned i = 0; i < 20U; i++) {
            is_x[i] = dot(unit_of(points[i]), unit_of(plane[0])) > 0.0;
            of_x += is_x[i];
        }
        if (of_x > 0U && of_x < 20U) {
            CHECK_EQ(curves(points, 20, is_x), 1);
        }
        draw(points, 10, 1.3); // each in half a sphere
        draw(points + 10, 10, 1.3);
        for (unsigned i = 0; i < 20U; i++) {
            is_x[i] = i < 10U;
        }
        several += curves(points, 20, is_x) > 1U;
    }
    check_note("of 600 pairs of hemispherical sets, with several curves", several);
    CHECK(several > 60U);
}

static unsigned nearest(const struct vec3 *points, unsigned from, unsigned to, struct vec3 site) {
    unsigned best = from;
    for (unsigned i = from; i < to; i++) {
        best = dot(unit_of(points[i]), unit_of(site)) > dot(unit_of(points[best]), unit_of(site))
                   ? i
                   : best;
    }
    return best;
}

/// Step 1's search may stop before the closest pair; but what it finds, two sites that are each
/// other's nearest, is enough: P passes through the middle. And the distance from a site has
/// several minima round the other set, which a walk in one direction takes for the least.
static void step_one_need_not_find_the_closest_pair(void) {
    unsigned other = 0, several = 0;
    for (unsigned t = 0; t < 600U && check_clean(); t++) {
        struct vec3 points[20], plane[1], mixed[20];
        draw(mixed, 20, 1.5);
        plane[0] = vec3(mixed[0].y, -mixed[0].x, mixed[0].z / 7);
        unsigned of_x = 0, y = 20;
        for (unsigned i = 0; i < 20U; i++) {
            const bool is_x = dot(unit_of(mixed[i]), unit_of(plane[0])) > 0.0;
            points[is_x ? of_x++ : --y] = mixed[i];
        }
        if (of_x < 3U || of_x > 17U) {
            continue;
        }
        unsigned a = 0, b = nearest(points, of_x, 20, points[0]), last;
        do {
            last = a;
            a = nearest(points, 0, of_x, points[b]);
            b = nearest(points, of_x, 20, points[a]);
        } while (a != last);
        bool closest = true;
        for (unsigned i = 0; i < of_x; i++) {
            for (unsigned k = of_x; k < 20U; k++) {
                closest =
                    closest && exact_distance_cmp(points[i], points[k], points[a], points[b]) >= 0;
            }
        }
        other += !closest;
        for (unsigned i = 0; i < 20U; i++) {
            CHECK(i == a || i == b || exact_cap_sign(points[a], points[b], points[i]) > 0);
        }
        struct hull_result hull;
        unsigned minima = 0;
        if (hull_spherical(points, of_x, workspace, sizeof workspace, &hull) == HULL_OK) {
            for (unsigned i = 0; i < hull.vertex_count; i++) {
                const unsigned n = hull.vertex_count;
                const struct vec3 here = points[hull.vertices[i]];
                minima += exact_distance_cmp(points[b], here, points[b],
                                             points[hull.vertices[(i + 1U) % n]]) < 0 &&
                          exact_distance_cmp(points[b], here, points[b],
                                             points[hull.vertices[(i + n - 1U) % n]]) < 0;
            }
        }
        several += minima > 1U;
    }
    check_note("searches that end at another pair than the closest", other);
    check_note("sites with several minima round the other set", several);
    CHECK(other > 60U && several > 5U);
}

// ---------------------------------------------------------------- the search of 1982

/// Each feasible triple without an obtuse angle has the one answer, so "greatest [V, V1]" compares
/// nothing.
static void triples_need_no_comparison(void) {
    unsigned triples = 0;
    for (unsigned t = 0; t < 300U && check_clean(); t++) {
        struct vec3 points[9];
        draw(points, 9, 0.05 + 1.3 * uniform());
        const double optimum = optimum_of(points, 9);
        for (uint32_t i = 0; i < 9U; i++) {
            for (uint32_t j = i + 1U; j < 9U; j++) {
                for (uint32_t k = j + 1U; k < 9U; k++) {
                    struct vec3 axis;
                    if (exact_holds_cone(points, 9, (uint32_t[]){i, j, k}, 3) &&
                        exact_circle_axis(points[i], points[j], points[k], &axis)) {
                        const double angle = apart(unit_of(axis), unit_of(points[i]));
                        triples++;
                        CHECK(fabs(fmin(angle, 3.141592653589793 - angle) - optimum) < 1e-8);
                    }
                }
            }
        }
    }
    CHECK(triples > 100U);
}

// ---------------------------------------------------------------- narrow cones

static double largest_angle(const struct vec3 *points, unsigned count, struct unit axis) {
    double largest = 0.0;
    for (unsigned i = 0; i < count; i++) {
        largest = fmax(largest, apart(axis, unit_of(points[i])));
    }
    return largest;
}

/// "Least scalar product": of unit vectors in Q1.30, as programs have them, the axis of the largest
/// least product is that of the vectors whose lengths were rounded down.
static void products_of_rounded_vectors(void) {
    const double radii[] = {0.1, 1e-3, 1e-6};
    double wider[3] = {0};
    for (unsigned t = 0; t < 600U && check_clean(); t++) {
        struct vec3 points[8];
        struct min_norm_point point[8];
        struct min_norm nearest_point;
        draw(points, 8, radii[t % 3U]);
        for (uint32_t i = 0; i < 8U; i++) { // lengths as they are
            point[i] = (struct min_norm_point){.index = i, .exact = vec3_widen(points[i])};
        }
        min_norm_start(&nearest_point, &point[0], false);
        for (unsigned i = 0; i < 8U; i++) {
            if (min_norm_violated_by(&nearest_point, &point[i])) {
                CHECK(min_norm_enter(&nearest_point, &point[i]));
                i = UINT32_MAX; // from the first again
            }
        }
        const struct vec3_i64 along = min_norm_direction(&nearest_point);
        struct cone_result result;
        CHECK_EQ(methods[METHOD_PIVOT].solve(points, 8, &result), CONE_OK);
        const double ours = largest_angle(points, 8, unit_of(result.axis_q30));
        const double theirs = largest_angle(
            points, 8,
            normalised((struct unit){(double)along.x, (double)along.y, (double)along.z}));
        wider[t % 3U] += (theirs / ours - 1.0) / 200.0;
        CHECK(theirs > ours - 2e-9);
    }
    check_note("by rounded products, wider by parts in 10^6 at 0.1 rad", (int64_t)(wider[0] * 1e6));
    check_note("at 0.001 rad", (int64_t)(wider[1] * 1e6));
    check_note("at 0.000001 rad", (int64_t)(wider[2] * 1e6));
    CHECK(wider[0] < 1e-6 && wider[2] > 0.1);
}

// ---------------------------------------------------------------- pictures

/// VR = (0, 0, 1) x VA, and VU = VA x VR: a mirror image; with the VU = VR x VA of the beginning it
/// is upside down. Equation 4 of 1985 is right.
static void handedness_of_1982(void) {
    const struct unit a = {0, 1, 0}, z = {0, 0, 1}, r = cross(z, a);
    const struct unit mirrored = cross(a, r), upside_down = cross(r, a);
    CHECK(dot(r, cross(a, mirrored)) == -1.0 && mirrored.z == 1.0);
    CHECK(dot(r, cross(a, upside_down)) == 1.0 && upside_down.z == -1.0);
    const struct orient_axes axes = orient_axes(vec3(0, Q30_ONE, 0), vec3(0, 0, 1));
    CHECK(vec3_equal(axes.right_q30, vec3(Q30_ONE, 0, 0)));
    CHECK(vec3_equal(axes.up_q30, vec3(0, 0, Q30_ONE)));
}

/// The picture of a ball, by rays along its rim: equation 4's major axis is exact, equation 5's
/// minor axis only in the limit of small balls; and their ratio goes to 1 / cos a.
static void distortion(void) {
    for (unsigned t = 0; t < 100U; t++) {
        const double a = 1.2 * uniform(), b = 0.02 + 0.3 * uniform() * (1.5 - a);
        double low = INFINITY, high = -INFINITY, across = 0.0;
        for (unsigned i = 0; i < 20000U; i++) {
            const double turn = 6.283185307179586 * i / 20000.0;
            const double along = cos(b), up = sin(b) * cos(turn), side = sin(b) * sin(turn);
            const double depth = along * cos(a) - up * sin(a); // the ball's cone, turned by a
            low = fmin(low, (along * sin(a) + up * cos(a)) / depth);
            high = fmax(high, (along * sin(a) + up * cos(a)) / depth);
            across = fmax(across, side / depth);
        }
        const double r = 1.0 / cos(a), product = cos(a + b) * cos(a - b);
        const double major = r * sin(b) * (1.0 / cos(a + b) + 1.0 / cos(a - b)); // equation 4
        CHECK(fabs((high - low) / major - 1.0) < 1e-6);
        CHECK(across > r * sin(b) * (1.0 + 0.4 * b * b)); // half of equation 5 is r sin b
        CHECK(fabs(across / (sin(b) / sqrt(product)) - 1.0) < 1e-6);
        CHECK(fabs((high - low) / 2.0 / across / (cos(b) / sqrt(product)) - 1.0) < 1e-6);
    }
    CHECK(fabs(cos(1e-4) / sqrt(cos(1.1 + 1e-4) * cos(1.1 - 1e-4)) * cos(1.1) - 1.0) < 1e-6);
}

/// Equation 18 with f the angle itself is no pan: between two objects the best direction jumps from
/// one to the other at equal weights.
static void the_angle_itself_jumps(void) {
    double best_at[2];
    for (unsigned side = 0; side < 2U; side++) {
        const double w = side == 0U ? 0.501 : 0.499;
        double least_cost = INFINITY;
        for (unsigned i = 0; i <= 1000U; i++) {
            const double at = i * 1e-3, cost = w * at + (1.0 - w) * (1.0 - at);
            best_at[side] = cost < least_cost ? at : best_at[side];
            least_cost = fmin(least_cost, cost);
        }
    }
    CHECK(best_at[0] == 0.0 && best_at[1] == 1.0);
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(shrinking);
    TEST(separable_not_hemispherical);
    TEST(step_one_need_not_find_the_closest_pair);
    TEST(triples_need_no_comparison);
    TEST(products_of_rounded_vectors);
    TEST(handedness_of_1982);
    TEST(distortion);
    TEST(the_angle_itself_jumps);
    exact_roots_free();
    return check_finish();
}

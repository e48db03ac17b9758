/// hull_spherical against the definition of the hull, in exact integers.
///
/// Small sets: a pair of points is an edge if all others lie right of it, or on it between its
/// ends; following the edges gives the wanted list. Every set of up to seven of the 26 directions
/// with components -1, 0, 1, every sequence of up to four of them, and random degenerate sets.
/// Larger sets: every edge of the answer has all points on its right. COUNT=N random small sets,
/// SEED=N.
#include "check.h"
#include "property/support/cone_brute.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"

#include "sphere/hull.h"

#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long small_count = 500000UL, feasible_sets, infeasible_sets, arcs, polygons;

static uint32_t below(uint32_t limit) {
    return (uint32_t)((check_random(&seed) >> 32) * limit >> 32);
}

// ---------------------------------------------------------------- the hull by its definition

/// Sign of the first component of a x b that is not zero: comparable among vectors of one plane.
static int turn(struct vec3 a, struct vec3 b) {
    const int64_t component[3] = {(int64_t)a.y * b.z - (int64_t)a.z * b.y,
                                  (int64_t)a.z * b.x - (int64_t)a.x * b.z,
                                  (int64_t)a.x * b.y - (int64_t)a.y * b.x};
    for (unsigned i = 0; i < 3U; i++) {
        if (component[i] != 0) {
            return component[i] > 0 ? 1 : -1;
        }
    }
    return 0;
}

/// Is k, of the plane of i and j and parallel to neither, on the short arc between them?
static bool between(struct vec3 i, struct vec3 j, struct vec3 k) {
    return turn(i, k) == turn(i, j) && turn(k, j) == turn(i, j);
}

/// Is k no obstacle to the edge from i to j?
static bool allows_edge(struct vec3 i, struct vec3 j, struct vec3 k) {
    const int side = brute_det_sign(i, j, k);
    return side < 0 || (side == 0 && between(i, j, k));
}

static bool is_edge(const struct vec3 *points, const unsigned *list, unsigned count, unsigned i,
                    unsigned j) {
    for (unsigned k = 0; k < count; k++) {
        if (k != i && k != j && !allows_edge(points[list[i]], points[list[j]], points[list[k]])) {
            return false;
        }
    }
    return true;
}

/// The ends of an arc: every other point is between them.
static unsigned arc_ends(const struct vec3 *points, const unsigned *list, unsigned count,
                         uint32_t *hull) {
    for (unsigned i = 0; i < count; i++) {
        for (unsigned j = i + 1U; j < count; j++) {
            bool all_between = true;
            for (unsigned k = 0; k < count; k++) {
                all_between =
                    all_between && (k == i || k == j ||
                                    between(points[list[i]], points[list[j]], points[list[k]]));
            }
            if (all_between) {
                hull[0] = list[i];
                hull[1] = list[j];
                return 2;
            }
        }
    }
    return 0;
}

/// The hull of a feasible set; its size.
static unsigned reference_hull(const struct vec3 *points, uint32_t count, uint32_t *hull) {
    unsigned list[BRUTE_COUNT_MAX] = {0}, distinct = 0;
    for (unsigned i = 0; i < count; i++) {
        unsigned j = 0;
        while (j < distinct && brute_parallel(points[i], points[list[j]]) == 0) {
            j++;
        }
        if (j == distinct) {
            list[distinct++] = i;
        }
    }
    hull[0] = list[0];
    bool flat = true;
    for (unsigned k = 2; k < distinct; k++) {
        flat = flat && brute_det_sign(points[list[0]], points[list[1]], points[list[k]]) == 0;
    }
    if (distinct == 1U) {
        return 1;
    }
    if (flat) {
        return arc_ends(points, list, distinct, hull);
    }
    unsigned next[BRUTE_COUNT_MAX] = {0}, first = distinct;
    for (unsigned i = distinct; i-- > 0U;) {
        for (unsigned j = 0; j < distinct; j++) {
            if (i != j && is_edge(points, list, distinct, i, j)) {
                next[i] = j;
                first = i;
            }
        }
    }
    unsigned size = 0;
    for (unsigned at = first; size == 0U || at != first; at = next[at]) {
        hull[size++] = list[at];
    }
    return size;
}

// ---------------------------------------------------------------- one set

static void print_set(const struct vec3 *points, uint32_t count, const struct hull_result *result) {
    printf("  # set of %u:\n", count);
    for (uint32_t i = 0; i < count && i < 20U; i++) {
        printf("  %d %d %d\n", points[i].x, points[i].y, points[i].z);
    }
    printf("  # got:");
    for (uint32_t i = 0; i < result->vertex_count && i < 20U; i++) {
        printf(" %u", result->vertices[i]);
    }
    printf("\n");
}

static uint32_t workspace[HULL_WORKSPACE_BYTES(20000) / sizeof(uint32_t)];

static enum hull_status solve(const struct vec3 *points, uint32_t count,
                              struct hull_result *result) {
    return hull_spherical(points, count, workspace, HULL_WORKSPACE_BYTES(count), result);
}

/// Every way to sort and to filter: the same answer. Which points witness may differ.
static bool all_ways_agree(const struct vec3 *points, uint32_t count, enum hull_status status,
                           const struct hull_result *wanted) {
    static uint32_t corners[20000], other[HULL_WORKSPACE_BYTES(20000) / sizeof(uint32_t)];
    for (uint32_t i = 0; i < wanted->vertex_count; i++) {
        corners[i] = wanted->vertices[i];
    }
    for (unsigned way = 0; way < 4U; way++) {
        const struct hull_options options = {way / 2U == 0U ? HULL_ORDER_MERGE : HULL_ORDER_BUCKETS,
                                             way % 2U != 0U};
        struct hull_result result;
        if (!CHECK_EQ(hull_by(points, count, &options, other, HULL_WORKSPACE_BYTES(count), &result),
                      status) ||
            !CHECK_EQ(result.vertex_count, wanted->vertex_count)) {
            return false;
        }
        for (uint32_t i = 0; i < result.vertex_count; i++) {
            if (!CHECK_EQ(result.vertices[i], corners[i])) {
                return false;
            }
        }
        if (status == HULL_NOT_HEMISPHERICAL &&
            !CHECK(exact_check_witness(points, count, result.witness, result.witness_count) ==
                   NULL)) {
            return false;
        }
    }
    return true;
}

static bool check_small(const struct vec3 *points, uint32_t count) {
    struct hull_result result;
    const enum hull_status status = solve(points, count, &result);
    bool right;
    if (brute_zero_in_hull(points, count)) {
        infeasible_sets++;
        right =
            CHECK_EQ(status, HULL_NOT_HEMISPHERICAL) &&
            CHECK(exact_check_witness(points, count, result.witness, result.witness_count) == NULL);
    } else {
        uint32_t wanted[BRUTE_COUNT_MAX];
        const unsigned size = reference_hull(points, count, wanted);
        feasible_sets++;
        arcs += size == 2U;
        polygons += size > 2U;
        right = CHECK_EQ(status, HULL_OK) && CHECK_EQ(result.vertex_count, size);
        for (unsigned i = 0; right && i < size; i++) {
            right = CHECK_EQ(result.vertices[i], wanted[i]);
        }
    }
    if ((feasible_sets + infeasible_sets) % 4U == 0U) {
        right = right && all_ways_agree(points, count, status, &result);
    }
    if (!right) {
        print_set(points, count, &result);
    }
    return right;
}

// ---------------------------------------------------------------- small integers, all of them

/// In a random order, so that any of the points is the first.
static void every_set_of_up_to_seven(void) {
    for (uint32_t set = 1; set < UINT32_C(1) << 26 && check_clean(); set++) {
        struct vec3 points[7];
        const uint32_t count = cone_sets_of_bits(set, 7, points);
        if (count != 0U) {
            cone_sets_shuffle(&seed, points, count);
            check_small(points, count);
        }
    }
}

static void every_sequence_of_up_to_four(void) {
    for (uint32_t i = 0; i < 27U * 27U * 27U * 27U && check_clean(); i++) {
        struct vec3 points[4];
        uint32_t count = 0;
        for (uint32_t rest = i; rest != 0U; rest /= 27U) {
            if (rest % 27U != 0U) { // the digit 0 is no point
                count += cone_sets_of_bits(UINT32_C(1) << (rest % 27U - 1U), 1, &points[count]);
            }
        }
        if (count != 0U) {
            check_small(points, count);
        }
    }
}

// ---------------------------------------------------------------- random sets

static void random_small_sets(void) {
    for (unsigned long i = 0; i < small_count && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        check_small(points, count);
    }
}

/// All points right of every edge, the corners strictly convex, each named once and for the first
/// of its direction: then the list is the hull.
static bool is_hull(const struct vec3 *points, uint32_t count, const struct hull_result *result) {
    const uint32_t *v = result->vertices;
    const uint32_t size = result->vertex_count;
    for (uint32_t e = 0; e < size; e++) {
        const uint32_t from = v[e], to = v[(e + 1U) % size];
        if (e > 0U && v[e] <= v[0]) {
            return false;
        }
        for (uint32_t k = 0; k < count; k++) {
            const bool at_from = brute_parallel(points[from], points[k]) > 0;
            const bool at_to = brute_parallel(points[to], points[k]) > 0;
            if ((at_from && k < from) || (at_to && k < to)) {
                return false;
            }
            if (size == 1U
                    ? !at_from
                    : !at_from && !at_to && !allows_edge(points[from], points[to], points[k])) {
                return false;
            }
        }
    }
    return true;
}

static void random_larger_sets(void) {
    static struct vec3 points[20000];
    uint64_t vertices = 0;
    for (unsigned i = 0; i < 600U && check_clean(); i++) {
        const uint32_t count = i < 590U ? 13U + below(1U << (5U + below(6))) : 20000U;
        const enum cone_large_class class = (enum cone_large_class)(i % LARGE_COUNT);
        if (count == 20000U && class == LARGE_RING) {
            continue; // 20,000 corners times 20,000 points
        }
        cone_sets_draw_large(class, &seed, points, count);
        struct hull_result result;
        const enum hull_status status = solve(points, count, &result);
        bool right;
        if (status == HULL_NOT_HEMISPHERICAL) {
            right = CHECK(
                exact_check_witness(points, count, result.witness, result.witness_count) == NULL);
        } else {
            // Every edge having all points on its right shows the set hemispherical, too.
            vertices += result.vertex_count;
            right = CHECK_EQ(status, HULL_OK) && CHECK(result.vertex_count > 0U) &&
                    CHECK(is_hull(points, count, &result));
        }
        right = right && all_ways_agree(points, count, status, &result);
        if (!right) {
            print_set(points, count, &result);
        }
    }
    printf("# larger sets: %llu corners\n", (unsigned long long)vertices);
    CHECK(vertices > 10000U);
}

static void errors_are_named(void) {
    const struct vec3 points[] = {{1, 2, 3}, {0, 0, 0}, {0, 0, 0}};
    struct hull_result result;
    CHECK_EQ(solve(points, 0, &result), HULL_EMPTY);
    CHECK_EQ(solve(points, 3, &result), HULL_ERROR_ZERO_VECTOR);
    CHECK_EQ(result.bad_index, 1);
    CHECK_EQ(hull_spherical(points, 1, workspace, HULL_WORKSPACE_BYTES(1) - 1U, &result),
             HULL_ERROR_WORKSPACE);
    CHECK_EQ(hull_spherical(points, 1, workspace, HULL_WORKSPACE_BYTES(1), &result), HULL_OK);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19720613U;
    small_count = count_text != NULL ? strtoul(count_text, NULL, 0) : small_count;
    printf("# seed %llu, %lu random small sets\n", (unsigned long long)seed, small_count);
    TEST(every_set_of_up_to_seven);
    TEST(every_sequence_of_up_to_four);
    TEST(random_small_sets);
    printf("# small sets: %lu with a hull (%lu arcs, %lu polygons), %lu without\n", feasible_sets,
           arcs, polygons, infeasible_sets);
    TEST(random_larger_sets);
    TEST(errors_are_named);
    exact_free();
    return check_finish();
}

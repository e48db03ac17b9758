/// Voronoi diagrams against their definition, both constructions against each other, and Lemma 1.
///
/// Small sets: every circle through three sites is tried by reals of 1,200 bits
/// (support/exact_roots.h); those without a site inside are the vertices, pairs of sites on two of
/// them the edges. Larger sets: no site lies inside any vertex' circle, and with Euler's formula
/// there is no other vertex. COUNT=N small sets, SEED=N.
#include "check.h"
#include "property/support/cone_brute.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"
#include "property/support/exact_roots.h"

#include "sphere/voronoi.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGE_MAX 3000U
#define SMALL_MAX 8U

static uint64_t seed;
static unsigned long small_count = 3000UL, flats, joined;
static uint64_t workspace[2][VORONOI_WORKSPACE_BYTES(LARGE_MAX) / sizeof(uint64_t) + 1U];

static uint32_t below(uint32_t limit) {
    return (uint32_t)((check_random(&seed) >> 32) * limit >> 32);
}

static void print_set(const struct vec3 *points, uint32_t count) {
    printf("  # set of %u:\n", count);
    for (uint32_t i = 0; i < count && i < 20U; i++) {
        printf("  %d %d %d\n", points[i].x, points[i].y, points[i].z);
    }
}

static bool draw(const struct vec3 *points, uint32_t count, bool closest, bool merge,
                 unsigned place, struct voronoi_result *result) {
    const struct voronoi_options options = {.closest = closest, .merge = merge};
    return CHECK_EQ(voronoi_diagram(points, count, &options, workspace[place],
                                    VORONOI_WORKSPACE_BYTES(count), result),
                    VORONOI_OK);
}

// ---------------------------------------------------------------- two diagrams

static bool same_lists(const struct voronoi_result *a, const struct voronoi_result *b) {
    if (!CHECK_EQ(a->site_count, b->site_count) || !CHECK_EQ(a->vertex_count, b->vertex_count) ||
        !CHECK_EQ(a->edge_count, b->edge_count) ||
        !CHECK(memcmp(a->sites, b->sites, a->site_count * sizeof *a->sites) == 0)) {
        return false;
    }
    for (uint32_t v = 0; v < a->vertex_count; v++) {
        const struct voronoi_vertex *va = &a->vertices[v], *vb = &b->vertices[v];
        if (!CHECK_EQ(va->count, vb->count) ||
            !CHECK(memcmp(a->vertex_sites + va->first, b->vertex_sites + vb->first,
                          va->count * sizeof(uint32_t)) == 0)) {
            return false;
        }
    }
    return true;
}

static bool same_diagram(const struct voronoi_result *a, const struct voronoi_result *b) {
    if (!same_lists(a, b)) {
        return false;
    }
    for (uint32_t v = 0; v < a->vertex_count; v++) {
        if (!CHECK(vec3_equal(a->vertices[v].at_q30, b->vertices[v].at_q30))) {
            return false;
        }
    }
    return CHECK(a->edge_count == 0U ||
                 memcmp(a->edges, b->edges, a->edge_count * sizeof *a->edges) == 0);
}

/// Regions of sites, edges, vertices: V - E + F = 2 from three sites on.
static bool check_euler(const struct voronoi_result *r) {
    if (r->site_count < 3U) {
        return CHECK_EQ(r->vertex_count, 0) && CHECK_EQ(r->edge_count, r->site_count - 1U) &&
               (r->edge_count == 0U || (CHECK_EQ(r->edges[0].vertex[0], VORONOI_NONE) &&
                                        CHECK_EQ(r->edges[0].vertex[1], VORONOI_NONE)));
    }
    return CHECK_EQ(r->vertex_count + r->site_count, r->edge_count + 2U);
}

/// The farthest-point diagram is the closest-point diagram of the opposite points (Lemma 1), and
/// the antipodal image of that of the points.
static bool check_lemma(const struct vec3 *points, uint32_t count,
                        const struct voronoi_result *farthest) {
    static struct vec3 opposite[LARGE_MAX];
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 p = points[i];
        if (p.x == INT32_MIN || p.y == INT32_MIN || p.z == INT32_MIN) {
            return true; // has no opposite in int32
        }
        opposite[i] = vec3_neg(p);
    }
    struct voronoi_result closest;
    return draw(opposite, count, true, below(2) != 0U, 1, &closest) &&
           same_diagram(farthest, &closest);
}

static bool check_antipodal(const struct vec3 *points, uint32_t count,
                            const struct voronoi_result *farthest) {
    struct voronoi_result closest;
    if (!draw(points, count, true, false, 1, &closest)) {
        return false;
    }
    // The two vertices of sites on one circle are each other's antipodes, too, and change places.
    const bool flat = closest.vertex_count == 2U;
    bool right = same_lists(farthest, &closest);
    for (uint32_t v = 0; right && v < closest.vertex_count; v++) {
        const struct voronoi_vertex *image = &closest.vertices[flat ? 1U - v : v];
        right = CHECK(vec3_equal(farthest->vertices[v].at_q30, vec3_neg(image->at_q30)));
    }
    return right;
}

// ---------------------------------------------------------------- by definition

struct circle {
    struct vec3 axis_q30;
    uint32_t sites; ///< bits
};

/// The circles through three sites that hold no other inside; their number.
static uint32_t all_circles(const struct vec3 *p, uint32_t sites, struct circle *circles) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < SMALL_MAX; i++) {
        for (uint32_t j = i + 1U; j < SMALL_MAX; j++) {
            for (uint32_t k = j + 1U; k < SMALL_MAX; k++) {
                const uint32_t three = 1U << i | 1U << j | 1U << k;
                if ((sites & three) != three) {
                    continue;
                }
                uint32_t on = three, inside = 0, outside = 0;
                for (uint32_t x = 0; x < SMALL_MAX; x++) {
                    if ((sites & ~three & 1U << x) != 0U) {
                        const int sign = exact_plane_sign(p[i], p[j], p[k], p[x]);
                        *(sign > 0 ? &inside : sign < 0 ? &outside : &on) |= 1U << x;
                    }
                }
                // Each circle once: by its three first sites.
                if ((on & ~three & ((1U << k) - 1U)) != 0U) {
                    continue;
                }
                if (inside == 0U) {
                    circles[count].sites = on;
                    CHECK(exact_circle_axis(p[i], p[j], p[k], &circles[count++].axis_q30));
                }
                if (outside == 0U) {
                    circles[count].sites = on;
                    CHECK(exact_circle_axis(p[i], p[k], p[j], &circles[count++].axis_q30));
                }
            }
        }
    }
    return count;
}

static uint32_t bits_of(const uint32_t *list, uint32_t count) {
    uint32_t bits = 0;
    for (uint32_t i = 0; i < count; i++) {
        bits |= 1U << list[i];
    }
    return bits;
}

static bool is_near(struct vec3 a, struct vec3 b) {
    return llabs((int64_t)a.x - b.x) <= 1 && llabs((int64_t)a.y - b.y) <= 1 &&
           llabs((int64_t)a.z - b.z) <= 1;
}

static bool check_vertices(const struct voronoi_result *r, const struct circle *circles,
                           uint32_t count) {
    if (!CHECK_EQ(r->vertex_count, count)) {
        return false;
    }
    for (uint32_t c = 0; c < count; c++) {
        bool found = false;
        for (uint32_t v = 0; v < count; v++) {
            const struct voronoi_vertex *vertex = &r->vertices[v];
            found = found ||
                    (bits_of(r->vertex_sites + vertex->first, vertex->count) == circles[c].sites &&
                     is_near(vertex->at_q30, circles[c].axis_q30));
        }
        if (!CHECK(found)) {
            return false;
        }
    }
    return true;
}

/// Sites on one circle: neighbours are those with all others on one side of their chord.
static bool are_neighbours(const struct vec3 *p, uint32_t sites, uint32_t a, uint32_t b) {
    bool any = false;
    struct vec3 first = {0, 0, 0}, axis;
    for (uint32_t x = 0; x < SMALL_MAX; x++) {
        if ((sites & 1U << x) != 0U && x != a && x != b) {
            CHECK(exact_circle_axis(p[a], p[b], p[x], &axis));
            if (any && vec3_dot_unit(first, axis) < 0) {
                return false;
            }
            first = any ? first : axis;
            any = true;
        }
    }
    return true;
}

static bool check_edges(const struct vec3 *p, uint32_t sites, const struct voronoi_result *r) {
    uint32_t count = 0;
    const bool flat = r->vertex_count == 2U;
    flats += flat;
    for (uint32_t a = 0; a < SMALL_MAX; a++) {
        for (uint32_t b = a + 1U; b < SMALL_MAX; b++) {
            uint32_t at[SMALL_MAX * 2U], vertices = 0;
            const uint32_t both = 1U << a | 1U << b;
            for (uint32_t v = 0; v < r->vertex_count; v++) {
                const uint32_t bits =
                    bits_of(r->vertex_sites + r->vertices[v].first, r->vertices[v].count);
                if ((bits & both) == both) {
                    at[vertices++] = v;
                }
            }
            if (vertices < 2U || (flat && !are_neighbours(p, sites, a, b))) {
                continue;
            }
            const struct voronoi_edge *edge = &r->edges[count];
            if (!CHECK_EQ(vertices, 2) || !CHECK(count < r->edge_count) ||
                !CHECK_EQ(edge->site[0], a) || !CHECK_EQ(edge->site[1], b) ||
                !CHECK_EQ(edge->vertex[0], at[0]) || !CHECK_EQ(edge->vertex[1], at[1])) {
                return false;
            }
            count++;
        }
    }
    return CHECK_EQ(r->edge_count, count);
}

static uint32_t distinct(const struct vec3 *points, uint32_t count) {
    uint32_t bits = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool again = false;
        for (uint32_t j = 0; j < i; j++) {
            again = again || brute_parallel(points[i], points[j]) > 0;
        }
        bits |= again ? 0U : 1U << i;
    }
    return bits;
}

static bool check_by_definition(const struct vec3 *points, uint32_t count,
                                const struct voronoi_result *closest) {
    struct circle circles[SMALL_MAX * SMALL_MAX * SMALL_MAX];
    const uint32_t sites = distinct(points, count);
    if (!CHECK_EQ(bits_of(closest->sites, closest->site_count), sites) ||
        closest->site_count < 3U) {
        return check_clean();
    }
    const uint32_t found = all_circles(points, sites, circles);
    joined += closest->vertex_count + 4U < 2U * closest->site_count;
    return check_vertices(closest, circles, found) && check_edges(points, sites, closest);
}

// ---------------------------------------------------------------- the tests

static bool check_set(const struct vec3 *points, uint32_t count) {
    struct voronoi_result inserted, merged;
    return draw(points, count, false, false, 0, &inserted) &&
           draw(points, count, false, true, 1, &merged) && same_diagram(&inserted, &merged) &&
           check_euler(&inserted) && check_lemma(points, count, &inserted) &&
           check_antipodal(points, count, &inserted);
}

static void small_sets(void) {
    for (unsigned long i = 0; i < small_count && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        count = count < SMALL_MAX ? count : SMALL_MAX;
        struct voronoi_result closest;
        if (!check_set(points, count) || !draw(points, count, true, i % 2U != 0U, 0, &closest) ||
            !check_by_definition(points, count, &closest)) {
            print_set(points, count);
        }
    }
    printf("# %lu sets on one circle, %lu with a vertex of four sites or more\n", flats, joined);
    CHECK(small_count < 1000UL || (flats > small_count / 50U && joined > small_count / 20U));
}

static void every_set_of_up_to_five(void) {
    for (uint32_t set = 1; set < UINT32_C(1) << 26 && check_clean(); set++) {
        struct vec3 points[5];
        const uint32_t count = cone_sets_of_bits(set, 5, points);
        if (count != 0U) {
            cone_sets_shuffle(&seed, points, count);
            if (!check_set(points, count)) {
                print_set(points, count);
            }
        }
    }
}

/// No site inside the circle of any vertex, its sites on it.
static bool check_circles(const struct vec3 *points, const struct voronoi_result *r) {
    static struct site site[LARGE_MAX];
    for (uint32_t i = 0; i < r->site_count; i++) {
        site[i] = site_from(points[r->sites[i]]);
    }
    for (uint32_t v = 0; v < r->vertex_count; v++) {
        const uint32_t *list = r->vertex_sites + r->vertices[v].first;
        const struct site a = site_from(points[list[0]]), b = site_from(points[list[1]]),
                          c = site_from(points[list[2]]);
        struct vec3 axis;
        CHECK(exact_circle_axis(a.vector, b.vector, c.vector, &axis));
        const int outward = vec3_dot_unit(axis, r->vertices[v].at_q30) > 0 ? 1 : -1;
        uint32_t on = 0;
        for (uint32_t i = 0; i < r->site_count; i++) {
            const int sign = outward * site_plane_sign(&a, &b, &c, &site[i]);
            if (!CHECK(sign <= 0)) {
                return false;
            }
            on += sign == 0;
        }
        if (!CHECK_EQ(on, r->vertices[v].count)) {
            return false;
        }
    }
    return true;
}

static struct vec3 large[LARGE_MAX];

static void larger_sets(void) {
    for (unsigned i = 0; i < 120U && check_clean(); i++) {
        const uint32_t count = i % 40U == 0U ? LARGE_MAX : 9U + below(120);
        const enum cone_large_class class = (enum cone_large_class)(i / 2U % LARGE_COUNT);
        cone_sets_draw_large(class, &seed, large, count);
        struct voronoi_result closest;
        if (!check_set(large, count) ||
            (count < 200U &&
             (!draw(large, count, true, false, 0, &closest) || !check_circles(large, &closest)))) {
            printf("  # %s, %u points\n", cone_large_class_names[class], count);
        }
    }
}

static void general_position(void) {
    struct voronoi_result r;
    for (unsigned i = 0; i < 50U; i++) {
        cone_sets_draw_large(LARGE_SPHERE, &seed, large, 20);
        CHECK(draw(large, 20, false, i % 2U != 0U, 0, &r));
        CHECK_EQ(r.site_count, 20);
        CHECK_EQ(r.vertex_count, 36);
        CHECK_EQ(r.edge_count, 54);
    }
}

/// At most 8 n log2 n tests, also with all sites on one circle.
static void cost_grows_as_n_log_n(void) {
    for (unsigned i = 0; i < 2U * LARGE_COUNT; i++) {
        const enum cone_large_class class = (enum cone_large_class)(i / 2U);
        struct voronoi_result r;
        cone_sets_draw_large(class, &seed, large, 1000);
        if (!CHECK(draw(large, 1000, true, i % 2U != 0U, 0, &r)) || !CHECK(r.side_tests < 80000U)) {
            printf("  # %s: %llu tests\n", cone_large_class_names[class],
                   (unsigned long long)r.side_tests);
        }
    }
}

static void known_diagrams(void) {
    struct voronoi_result r;
    // The corners of a cube: six vertices of four sites, twelve edges.
    const struct vec3 cube[] = {{1, 1, 1},  {1, 1, -1},  {1, -1, 1},  {1, -1, -1},
                                {-1, 1, 1}, {-1, 1, -1}, {-1, -1, 1}, {-1, -1, -1}};
    CHECK(draw(cube, 8, true, true, 0, &r));
    CHECK_EQ(r.vertex_count, 6);
    CHECK_EQ(r.edge_count, 12);
    CHECK(vec3_equal(r.vertices[0].at_q30, vec3(Q30_ONE, 0, 0)));
    // Three on the equator: two poles, three meridians.
    const struct vec3 equator[] = {{1, 0, 0}, {-1, 2, 0}, {-1, -2, 0}, {5, 0, 0}};
    CHECK(draw(equator, 4, false, true, 0, &r));
    CHECK_EQ(r.site_count, 3);
    CHECK_EQ(r.vertex_count, 2);
    CHECK(vec3_equal(r.vertices[0].at_q30, vec3(0, 0, -Q30_ONE)));
    CHECK(vec3_equal(r.vertices[1].at_q30, vec3(0, 0, Q30_ONE)));
    CHECK_EQ(r.edge_count, 3);
    // Two sites, opposite: one edge, a great circle.
    const struct vec3 two[] = {{3, 0, 0}, {-7, 0, 0}};
    CHECK(draw(two, 2, false, false, 0, &r));
    CHECK_EQ(r.edge_count, 1);
    CHECK_EQ(r.edges[0].vertex[0], VORONOI_NONE);
    CHECK(draw(two, 1, false, false, 0, &r));
    CHECK_EQ(r.edge_count + r.vertex_count, 0);
}

static void errors_are_named(void) {
    const struct vec3 points[] = {{1, 2, 3}, {0, 0, 0}};
    const struct voronoi_options options = {.closest = true};
    struct voronoi_result r;
    CHECK_EQ(voronoi_diagram(points, 0, &options, workspace[0], sizeof workspace[0], &r),
             VORONOI_EMPTY);
    CHECK_EQ(voronoi_diagram(points, 2, &options, workspace[0], sizeof workspace[0], &r),
             VORONOI_ERROR_ZERO_VECTOR);
    CHECK_EQ(r.bad_index, 1);
    CHECK_EQ(
        voronoi_diagram(points, 1, &options, workspace[0], VORONOI_WORKSPACE_BYTES(1) - 1U, &r),
        VORONOI_ERROR_WORKSPACE);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19080428U;
    small_count = count_text != NULL ? strtoul(count_text, NULL, 0) : small_count;
    printf("# seed %llu, %lu small sets\n", (unsigned long long)seed, small_count);
    TEST(errors_are_named);
    TEST(known_diagrams);
    TEST(general_position);
    TEST(small_sets);
    TEST(every_set_of_up_to_five);
    TEST(larger_sets);
    TEST(cost_grows_as_n_log_n);
    exact_roots_free();
    exact_free();
    return check_finish();
}

/// What the papers say about each other: the hull in space with the viewpoint and the spherical
/// hull (Levine, Anderson); the smallest sphere of unit vectors and the narrowest cone (Lawson;
/// Gomez, Ramaswami, Toussaint, lemma 6.1). COUNT=N sets, SEED=N.
#include "check.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"
#include "property/support/solid_check.h"

#include "sphere/cone.h"
#include "sphere/hull.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MOST 400U

static uint64_t seed;
static unsigned long set_count = 20000UL;
static unsigned char hull_workspace[SOLID_HULL_WORKSPACE_BYTES(MOST + 1U)];
static uint32_t spherical_workspace[HULL_WORKSPACE_BYTES(MOST) / 4U];

static bool is_vertex(const struct solid_hull *hull, uint32_t index) {
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        if (hull->vertices[i] == index) {
            return true;
        }
    }
    return false;
}

/// On the ray of a direction lies a vertex, unless points of other directions reach as far.
static bool ray_has_vertex(const struct vec3 *points, uint32_t count, const struct solid_hull *hull,
                           uint32_t direction) {
    for (uint32_t i = 0; i < count; i++) {
        if (is_vertex(hull, i) && exact_parallel(points[i], points[direction]) &&
            exact_dot_sign(points[i], points[direction]) > 0) {
            return true;
        }
    }
    return false;
}

/// points[count] is the viewpoint, 0. It is a vertex exactly if some direction sees every point;
/// and then every extreme direction is a vertex.
static void spherical_extrema_are_vertices(void) {
    struct vec3 points[CONE_SETS_SMALL_MAX + 1];
    unsigned long seen = 0, extrema = 0;
    for (unsigned long i = 0; i < set_count && check_clean(); i++) {
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        points[count] = vec3(0, 0, 0);
        struct hull_result spherical;
        struct solid_hull hull;
        const enum hull_status status = hull_spherical(points, count, spherical_workspace,
                                                       sizeof spherical_workspace, &spherical);
        CHECK_EQ(solid_hull_find(points, count + 1U, SOLID_HULL_CAPS, hull_workspace,
                                 sizeof hull_workspace, &hull),
                 SOLID_HULL_OK);
        CHECK_EQ(is_vertex(&hull, count), status == HULL_OK);
        seen += status == HULL_OK;
        for (uint32_t k = 0; status == HULL_OK && k < spherical.vertex_count; k++) {
            CHECK(ray_has_vertex(points, count, &hull, spherical.vertices[k]));
            extrema++;
        }
    }
    printf("# %lu sets seen from somewhere, %lu extreme directions\n", seen, extrema);
}

/// The sphere's centre c and radius R, the cone's axis and half-angle a: c = cos a * axis, R = sin
/// a.
static void smallest_sphere_cuts_the_narrowest_cone(void) {
    static const enum cone_large_class classes[4] = {LARGE_CAP, LARGE_RING, LARGE_NORMAL,
                                                     LARGE_CIRCLE};
    struct vec3 points[MOST];
    static uint32_t workspace[SOLID_SPHERE_WORKSPACE_BYTES(MOST) / 4U];
    double worst_angle = 0, worst_radius = 0;
    for (unsigned long i = 0; i < set_count / 10U && check_clean(); i++) {
        const uint32_t count = 1U + solid_below(&seed, MOST);
        cone_sets_draw_large(classes[i % 4U], &seed, points, count);
        for (uint32_t k = 0; k < count; k++) {
            points[k] = cone_sets_normalise(points[k]);
        }
        const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT};
        struct cone_result cone;
        struct solid_sphere sphere;
        const double turn = 2 * acos(-1.0);
        if (cone_narrowest(points, count, &options, &cone) != CONE_OK) {
            continue;
        }
        const double half = ldexp((double)cone.half_angle_turn64, -64) * turn;
        CHECK_EQ(solid_sphere_find(points, count, workspace, sizeof workspace, &sphere),
                 SOLID_SPHERE_OK);
        // The rounding of the unit vectors tilts either by its share of the width.
        if (half < 1e-4 || half > 1.5) {
            continue;
        }
        const double c[3] = {ldexp((double)sphere.center_q30.x, -60),
                             ldexp((double)sphere.center_q30.y, -60),
                             ldexp((double)sphere.center_q30.z, -60)};
        const double a[3] = {ldexp(cone.axis_q30.x, -30), ldexp(cone.axis_q30.y, -30),
                             ldexp(cone.axis_q30.z, -30)};
        const double x = c[1] * a[2] - c[2] * a[1], y = c[2] * a[0] - c[0] * a[2],
                     z = c[0] * a[1] - c[1] * a[0];
        const double away = sqrt(x * x + y * y + z * z),
                     length = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        const double radius = ldexp((double)sphere.radius_q30, -60);
        const double angle_error = away / length * half, radius_error = fabs(radius - sin(half));
        worst_angle = fmax(worst_angle, angle_error);
        worst_radius = fmax(worst_radius, radius_error);
        CHECK(angle_error < 2e-8);
        CHECK(radius_error < 2e-8);
        CHECK(fabs(length - cos(half)) < 2e-8 / cos(half));
    }
    printf("# worst: axis times half-angle %.2g rad^2, radius %.2g\n", worst_angle, worst_radius);
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19850601U;
    set_count = count_text != NULL ? strtoul(count_text, NULL, 0) : set_count;
    printf("# seed %llu, %lu sets\n", (unsigned long long)seed, set_count);
    TEST(spherical_extrema_are_vertices);
    TEST(smallest_sphere_cuts_the_narrowest_cone);
    exact_free();
    return check_finish();
}

#include "plan.h"

#include "solid/side.h"

#include <math.h>
#include <stdlib.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double angle_between(const double a[3], const double b[3]) {
    double c[3];
    cross(c, a, b);
    return atan2(sqrt(dot(c, c)), dot(a, b));
}

/// A target as seen from the centre, with the sphere's radius as unit.
static void from_center(const struct plan_sphere *sphere, const struct plan *plan, uint32_t i,
                        double out[3]) {
    const struct vec3 t = plan->targets[i];
    const double c[3] = {t.x, t.y, t.z};
    for (int k = 0; k < 3; k++) {
        out[k] = (c[k] * plan->grid - plan->center[k]) / sphere->radius;
    }
}

/// The two points where a line pierces the sphere, if it does.
static void add_points(struct plan_sphere *sphere, const double a[3], const double b[3]) {
    double d[3];
    for (int k = 0; k < 3; k++) {
        d[k] = b[k] - a[k];
    }
    const double dd = dot(d, d), ad = dot(a, d), inside = ad * ad - dd * (dot(a, a) - 1);
    for (int side = -1; side <= 1 && inside >= 0; side += 2) {
        struct plan_point *const p = &sphere->points[sphere->point_count++];
        const double t = (-ad + side * sqrt(inside)) / dd;
        for (int k = 0; k < 3; k++) {
            p->direction[k] = a[k] + t * d[k];
        }
        p->gap_rad = angle_between(p->direction, sphere->toward);
    }
}

static void add_circle(struct plan_sphere *sphere, const double a[3], const double b[3],
                       const double c[3]) {
    double ab[3], ac[3], n[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = b[k] - a[k];
        ac[k] = c[k] - a[k];
    }
    cross(n, ab, ac);
    const double size = sqrt(dot(n, n)), height = dot(n, a) / size;
    if (!(fabs(height) < 1)) {
        return; // beside the sphere
    }
    struct plan_circle *const circle = &sphere->circles[sphere->circle_count++];
    for (int k = 0; k < 3; k++) {
        circle->normal[k] = n[k] / size;
    }
    circle->height = height;
    circle->gap_rad = fabs(angle_between(circle->normal, sphere->toward) -
                           atan2(sqrt(1 - height * height), height));
}

static int nearer_point(const void *a, const void *b) {
    const double x = ((const struct plan_point *)a)->gap_rad,
                 y = ((const struct plan_point *)b)->gap_rad;
    return x < y ? -1 : x > y;
}

static int nearer_circle(const void *a, const void *b) {
    const double x = ((const struct plan_circle *)a)->gap_rad,
                 y = ((const struct plan_circle *)b)->gap_rad;
    return x < y ? -1 : x > y;
}

static void add_all(struct plan_sphere *sphere, const struct plan *plan) {
    const uint32_t count = plan->target_count;
    for (uint32_t i = 0; i < count; i++) {
        double a[3], b[3], c[3];
        from_center(sphere, plan, i, a);
        for (uint32_t j = i + 1U; j < count; j++) {
            from_center(sphere, plan, j, b);
            add_points(sphere, a, b);
            for (uint32_t k = j + 1U; plan->planes && k < count; k++) {
                if (!side_collinear(plan->targets[i], plan->targets[j], plan->targets[k])) {
                    from_center(sphere, plan, k, c);
                    add_circle(sphere, a, b, c);
                }
            }
        }
    }
}

bool plan_sphere_set(struct plan_sphere *sphere, const struct plan *plan,
                     const struct plan_view *view) {
    *sphere = (struct plan_sphere){.tolerance_rad = INFINITY};
    for (int k = 0; k < 3; k++) {
        sphere->toward[k] = view->place[k] - plan->center[k];
    }
    sphere->radius = sqrt(dot(sphere->toward, sphere->toward));
    if (!(sphere->radius > 0)) {
        return true;
    }
    for (int k = 0; k < 3; k++) {
        sphere->toward[k] /= sphere->radius;
    }
    const size_t n = plan->target_count, pairs = n * (n + 1U) / 2U + 1U,
                 triples = plan->planes ? pairs * n / 3U + 1U : 1U;
    sphere->points = malloc(2U * pairs * sizeof *sphere->points);
    sphere->circles = malloc(triples * sizeof *sphere->circles);
    if (sphere->points == NULL || sphere->circles == NULL) {
        return false;
    }
    add_all(sphere, plan);
    qsort(sphere->points, sphere->point_count, sizeof *sphere->points, nearer_point);
    qsort(sphere->circles, sphere->circle_count, sizeof *sphere->circles, nearer_circle);
    if (sphere->point_count != 0U) {
        sphere->tolerance_rad = sphere->points[0].gap_rad;
    }
    if (sphere->circle_count != 0U && sphere->circles[0].gap_rad < sphere->tolerance_rad) {
        sphere->tolerance_rad = sphere->circles[0].gap_rad;
    }
    return true;
}

void plan_sphere_free(struct plan_sphere *sphere) {
    free(sphere->points);
    free(sphere->circles);
    sphere->points = NULL;
    sphere->circles = NULL;
}

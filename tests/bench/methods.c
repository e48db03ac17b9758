#include "bench/methods.h"

#include "sphere/cone.h"
#include "sphere/cone_answer.h"
#include "sphere/hull.h"
#include "sphere/pyramid.h"
#include "sphere/shrink.h"
#include "sphere/voronoi_circle.h"

#include <math.h>
#include <stddef.h>

static uint64_t workspace[BENCH_MOST_POINTS * 16U];
/// The points once more, as unit vectors: the exact circle's are of any length.
static struct vec3 unit[BENCH_MOST_POINTS];

static void unit_prepare(const struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const double x = points[i].x, y = points[i].y, z = points[i].z;
        const double scale = 0x1p30 / sqrt(x * x + y * y + z * z);
        unit[i] = vec3((int32_t)lround(x * scale), (int32_t)lround(y * scale),
                       (int32_t)lround(z * scale));
    }
}

static void answer(const struct cone_result *cone, struct bench_run *run) {
    run->point_reads = cone->point_reads;
    run->support_count = cone->support_count;
    run->axis_q30 = cone->axis_q30;
    run->half_angle_bam32 = cone->half_angle_bam32.bam;
}

// ---------------------------------------------------------------- a bare pass

/// The least that any method has to do: one 64-bit dot product a point.
static void bare_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    const struct vec3 axis = points[0];
    const int64_t x = axis.x, y = axis.y, z = axis.z;
    int64_t least = INT64_MAX;
    for (const struct vec3 *p = points; p < points + count; p++) {
        const int64_t dot = x * p->x + y * p->y + z * p->z;
        least = dot < least ? dot : least;
    }
    run->axis_q30.x = (int32_t)(least >> 32); // so that the loop isn't thrown away
    run->point_reads = count;
}

// ---------------------------------------------------------------- pivot

static uint32_t warm[3];
static uint8_t warm_count;

static void pivot(const struct vec3 *points, uint32_t count, bool is_warm, struct bench_run *run) {
    const size_t bytes = CONE_WORKSPACE_UNIT_BYTES(count);
    const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT,
                                         .workspace = workspace,
                                         .workspace_bytes = bytes,
                                         .warm = warm,
                                         .warm_count = is_warm ? warm_count : (uint8_t)0};
    struct cone_result result;
    run->infeasible = cone_narrowest(points, count, &options, &result) != CONE_OK;
    run->scratch_bytes = bytes;
    answer(&result, run);
    if (!is_warm) {
        warm_count = run->infeasible ? 0U : result.support_count;
        for (uint8_t i = 0; i < warm_count; i++) {
            warm[i] = result.support[i];
        }
    }
}

static void pivot_run(const struct vec3 *given, uint32_t count, struct bench_run *run) {
    (void)given;
    pivot(unit, count, false, run);
}

static void pivot_warm_prepare(const struct vec3 *points, uint32_t count) {
    struct bench_run ignored = {0};
    unit_prepare(points, count);
    pivot(unit, count, false, &ignored);
}

static void pivot_warm_run(const struct vec3 *given, uint32_t count, struct bench_run *run) {
    (void)given;
    pivot(unit, count, true, run);
}

// ---------------------------------------------------------------- the growing circle

/// Elzinga and Hearn 1972, on the sphere: the farthest point of all enters the circle of two or
/// three, which grows. What pivot does without sample, blocks and filters.
static void growing_run(const struct vec3 *given, uint32_t count, struct bench_run *run) {
    const struct vec3 *const points = unit;
    (void)given;
    struct min_norm support;
    const struct min_norm_point first = cone_point(points, 0);
    min_norm_start(&support, &first, true);
    for (;;) {
        run->axis_q30 = min_norm_axis(&support);
        run->iterations++;
        run->point_reads += count;
        uint32_t farthest = 0;
        int64_t least = INT64_MAX;
        for (uint32_t i = 0; i < count; i++) {
            const int64_t dot = vec3_dot_unit(run->axis_q30, points[i]);
            if (dot < least) {
                least = dot;
                farthest = i;
            }
        }
        const struct min_norm_point next = cone_point(points, farthest);
        if (!min_norm_violated_by(&support, &next)) {
            break;
        }
        if (!min_norm_enter(&support, &next)) {
            run->infeasible = true;
            break;
        }
    }
    run->support_count = support.count;
}

// ---------------------------------------------------------------- the hull

static void hull_of(const struct vec3 *points, uint32_t count, const struct hull_options *options,
                    struct bench_run *run) {
    struct hull_result result;
    run->infeasible =
        hull_by(points, count, options, workspace, sizeof workspace, &result) != HULL_OK;
    run->hull_size = run->infeasible ? 0U : result.vertex_count;
    run->scratch_bytes = HULL_WORKSPACE_BYTES(count);
    run->tests = result.comparisons;
}

/// As hull_spherical takes it: a filter first.
static void hull_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    hull_of(points, count, &(struct hull_options){.order = HULL_ORDER_BUCKETS, .filter = true},
            run);
}

static void hull_buckets_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    hull_of(points, count, &(struct hull_options){.order = HULL_ORDER_BUCKETS}, run);
}

static void hull_sorted_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    hull_of(points, count, &(struct hull_options){.order = HULL_ORDER_MERGE}, run);
}

// ---------------------------------------------------------------- Anderson's methods

/// From the farthest-point Voronoi diagram of all points, or of the hull.
static void diagram(const struct vec3 *points, uint32_t count,
                    const struct voronoi_circle_options *options, struct bench_run *run) {
    struct voronoi_circle_result result;
    run->infeasible =
        voronoi_circle(points, count, options, workspace, sizeof workspace, &result) != CONE_OK;
    run->scratch_bytes = result.bytes_needed;
    run->tests = result.side_tests;
    answer(&result.cone, run);
}

static void a_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    diagram(points, count, &(struct voronoi_circle_options){0}, run);
}

static void a_merge_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    diagram(points, count, &(struct voronoi_circle_options){.merge = true}, run);
}

static void b_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    diagram(points, count, &(struct voronoi_circle_options){.hull = true}, run);
}

static void c_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    struct shrink_result result;
    run->infeasible =
        shrink_narrowest(points, count, workspace, sizeof workspace, &result) != CONE_OK;
    run->scratch_bytes = SHRINK_WORKSPACE_BYTES(count);
    run->iterations = result.iterations;
    answer(&result.cone, run);
}

static void pyramid_run(const struct vec3 *points, uint32_t count, struct bench_run *run) {
    struct pyramid_result result;
    run->infeasible =
        pyramid_narrowest(points, count, workspace, sizeof workspace, &result) != CONE_OK;
    run->scratch_bytes = PYRAMID_WORKSPACE_BYTES(result.edges_most);
    run->faces = result.edges_most;
    run->tests = result.face_tests;
    answer(&result.cone, run);
}

// ---------------------------------------------------------------- aiming as is often done

static void aim_at(double x, double y, double z, struct bench_run *run) {
    const double scale = 0x1p30 / sqrt(x * x + y * y + z * z);
    run->axis_q30 =
        vec3((int32_t)lround(x * scale), (int32_t)lround(y * scale), (int32_t)lround(z * scale));
}

static void centroid_run(const struct vec3 *given, uint32_t count, struct bench_run *run) {
    int64_t x = 0, y = 0, z = 0;
    (void)given;
    for (uint32_t i = 0; i < count; i++) {
        x += unit[i].x;
        y += unit[i].y;
        z += unit[i].z;
    }
    aim_at((double)x, (double)y, (double)z, run);
}

/// At the centre of the box around the unit vectors.
static void box_run(const struct vec3 *given, uint32_t count, struct bench_run *run) {
    struct vec3 low = unit[0], high = unit[0];
    (void)given;
    for (uint32_t i = 1; i < count; i++) {
        const struct vec3 p = unit[i];
        low = vec3(p.x < low.x ? p.x : low.x, p.y < low.y ? p.y : low.y, p.z < low.z ? p.z : low.z);
        high = vec3(p.x > high.x ? p.x : high.x, p.y > high.y ? p.y : high.y,
                    p.z > high.z ? p.z : high.z);
    }
    aim_at((double)low.x + high.x, (double)low.y + high.y, (double)low.z + high.z, run);
}

const struct bench_method bench_methods[BENCH_METHODS] = {
    [BENCH_BARE] = {.name = "bare pass", .run = bare_run},
    [BENCH_PIVOT] = {.name = "pivot", .prepare = unit_prepare, .run = pivot_run},
    [BENCH_PIVOT_WARM] = {.name = "pivot, warm",
                          .prepare = pivot_warm_prepare,
                          .run = pivot_warm_run,
                          .needs_feasible = true},
    [BENCH_GROWING] = {.name = "growing circle", .prepare = unit_prepare, .run = growing_run},
    [BENCH_C] = {.name = "algorithm C", .run = c_run, .needs_feasible = true},
    [BENCH_A] = {.name = "algorithm A", .run = a_run, .needs_feasible = true},
    [BENCH_A_MERGE] = {.name = "A by merging", .run = a_merge_run, .needs_feasible = true},
    [BENCH_B] = {.name = "algorithm B", .run = b_run, .needs_feasible = true},
    [BENCH_PYRAMID] = {.name = "pyramid (1982)", .run = pyramid_run, .needs_feasible = true},
    [BENCH_HULL] = {.name = "hull", .run = hull_run, .needs_feasible = true},
    [BENCH_HULL_BUCKETS] = {.name = "hull, buckets",
                            .run = hull_buckets_run,
                            .needs_feasible = true},
    [BENCH_HULL_SORTED] = {.name = "hull, sorted", .run = hull_sorted_run, .needs_feasible = true},
    [BENCH_CENTROID] = {.name = "centroid aim",
                        .prepare = unit_prepare,
                        .run = centroid_run,
                        .needs_feasible = true,
                        .is_other_axis = true},
    [BENCH_BOX] = {.name = "box-centre aim",
                   .prepare = unit_prepare,
                   .run = box_run,
                   .needs_feasible = true,
                   .is_other_axis = true},
    [BENCH_CGAL_SPHERE] = {.name = "CGAL sphere",
                           .prepare = peer_sphere_prepare,
                           .run = peer_sphere_run,
                           .is_other_axis = true},
    [BENCH_CGAL_HULL] = {.name = "CGAL hull",
                         .prepare = peer_hull_prepare,
                         .run = peer_hull_run,
                         .needs_feasible = true},
};

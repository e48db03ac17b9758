/// The methods that `make bench-cone` compares. Each is run on one set at a time.
#ifndef BENCH_METHODS_H
#define BENCH_METHODS_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Sets are at most this large.
#define BENCH_MOST_POINTS 1000000U

/// What a run leaves behind; zero where a method has no such figure.
struct bench_run {
    uint64_t point_reads;
    uint64_t scratch_bytes;
    uint32_t hull_size; ///< extreme directions
    uint32_t faces;     ///< most that the pyramid had
    /// Of a point and a face (pyramid), a site and a circle (diagrams), two angles (hulls).
    uint64_t tests;
    uint32_t iterations;       ///< of a loop whose every round reads all that is left
    uint64_t half_angle_bam32; ///< of a cone that claims to be the narrowest
    uint8_t support_count;
    struct vec3 axis_q30;
    bool infeasible;
};

struct bench_method {
    const char *name;
    /// Work that isn't the method's own, such as another program's format; not measured. May be
    /// NULL.
    void (*prepare)(const struct vec3 *points, uint32_t count);
    /// NULL: not built.
    void (*run)(const struct vec3 *points, uint32_t count, struct bench_run *run);
    /// Only feasible sets.
    bool needs_feasible;
    /// Its axis need not be that of the narrowest cone.
    bool is_other_axis;
};

enum {
    BENCH_BARE,
    BENCH_PIVOT,
    BENCH_PIVOT_WARM,
    BENCH_GROWING,
    BENCH_C,
    BENCH_A,
    BENCH_A_MERGE,
    BENCH_B,
    BENCH_PYRAMID,
    BENCH_HULL,
    BENCH_HULL_BUCKETS,
    BENCH_HULL_SORTED,
    BENCH_CENTROID,
    BENCH_BOX,
    BENCH_CGAL_SPHERE,
    BENCH_CGAL_HULL,
    BENCH_METHODS
};

extern const struct bench_method bench_methods[BENCH_METHODS];

// peers.cpp: CGAL, from a distribution package. Weak: `make check` builds the benchmark without.
#pragma weak peer_sphere_prepare
#pragma weak peer_sphere_run
#pragma weak peer_hull_prepare
#pragma weak peer_hull_run
void peer_sphere_prepare(const struct vec3 *points, uint32_t count);
void peer_sphere_run(const struct vec3 *points, uint32_t count, struct bench_run *run);
void peer_hull_prepare(const struct vec3 *points, uint32_t count);
void peer_hull_run(const struct vec3 *points, uint32_t count, struct bench_run *run);

#endif

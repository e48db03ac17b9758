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
    uint32_t hull_size;  ///< extreme directions
    uint64_t face_tests; ///< of the pyramid
    uint32_t iterations; ///< of a loop whose every round reads all that is left
    uint8_t support_count;
    struct vec3 axis_q30;
    bool infeasible;
};

struct bench_method {
    const char *name;
    /// Work that isn't the method's own, such as another program's format; not measured. May be
    /// NULL.
    void (*prepare)(const struct vec3 *points, uint32_t count);
    void (*run)(const struct vec3 *points, uint32_t count, struct bench_run *run);
    /// The largest sets worth a run, for methods of higher order; 0: all.
    uint32_t most_points;
    /// The same for sets whose points are all on the hull.
    uint32_t most_on_hull;
    /// At most so many sets a size, for slow methods; 0: all.
    uint32_t most_trials;
    /// Only feasible sets.
    bool needs_feasible;
};

enum {
    BENCH_BARE,
    BENCH_PIVOT,
    BENCH_PIVOT_WARM,
    BENCH_GROWING,
    BENCH_HULL,
    BENCH_HULL_BUCKETS,
    BENCH_HULL_SORTED,
    BENCH_A,
    BENCH_A_MERGE,
    BENCH_B,
    BENCH_C,
    BENCH_PYRAMID,
    BENCH_CGAL_SPHERE,
    BENCH_CGAL_HULL,
    BENCH_METHODS
};

extern const struct bench_method bench_methods[BENCH_METHODS];

// peers.cpp: CGAL, from a distribution package.
void peer_sphere_prepare(const struct vec3 *points, uint32_t count);
void peer_sphere_run(const struct vec3 *points, uint32_t count, struct bench_run *run);
void peer_hull_prepare(const struct vec3 *points, uint32_t count);
void peer_hull_run(const struct vec3 *points, uint32_t count, struct bench_run *run);

#endif

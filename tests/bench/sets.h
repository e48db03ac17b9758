/// Sets of directions on which `make bench-cone` measures.
#ifndef BENCH_SETS_H
#define BENCH_SETS_H

#include "fixed/vec3.h"

#include <stdint.h>

enum bench_set {
    /// Uniform on a cap of 20 degrees.
    BENCH_CAP,
    /// Uniform in the volume of a truncated cone of half-angle 20 degrees, between distances 1 and
    /// 2 from the viewpoint (Anderson 1985, before equation 14).
    BENCH_TRUNCATED_CONE,
    /// Normally distributed on a plane, standard deviation 0.1 of its distance (before equation
    /// 15).
    BENCH_NORMAL,
    /// A silhouette of 12 points, all else well inside: h = O(1).
    BENCH_SILHOUETTE,
    /// All on one circle of 20 degrees, in random order: h = n.
    BENCH_CIRCLE,
    /// The same on half of it, in order: what algorithm C shrinks slowest on.
    BENCH_HALF_CIRCLE,
    /// All exactly on one circle, evenly and in order: Pythagorean triples (a, b, c) with
    /// a^2 + b^2 = c^2, of any length. Each circle that algorithm C tries drops two points: n / 2
    /// of them. What takes unit vectors gets them rounded, and no longer quite on a circle.
    BENCH_EXACT_CIRCLE,
    /// Uniform on a cap of 89.9 degrees.
    BENCH_NEAR_HEMISPHERE,
    /// Winding outward, 16 turns, to 20 degrees: each point beyond all before it.
    BENCH_SPIRAL,
    /// A surface over a square grid, seen from above a corner: what Anderson's program of 1982
    /// plotted with 40 x 40 points. n is a square.
    BENCH_SURFACE,
    /// Uniform on the whole sphere: no feasible orientation.
    BENCH_SPHERE,
    BENCH_SETS
};

extern const char *const bench_set_names[BENCH_SETS];

/// Fills n unit vectors in Q1.30 (the exact circle: of any length). All sets but the surface and
/// the exact circle are turned about a random axis. The same seed gives the same set.
void bench_fill(enum bench_set set, uint32_t n, uint64_t seed, struct vec3 *points);

#endif

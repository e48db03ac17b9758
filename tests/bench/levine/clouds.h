/// The eight kinds of random points of Levine 1975, chapter VII, and points that are all vertices.
#ifndef BENCH_LEVINE_CLOUDS_H
#define BENCH_LEVINE_CLOUDS_H

#include "fixed/vec3.h"

#include <stdint.h>

enum cloud {
    CLOUD_CUBE1, ///< normal numbers, each below 1, 2, 4 in size
    CLOUD_CUBE2,
    CLOUD_CUBE4,
    CLOUD_POLYHEDRON, ///< uniform in 0..2, 0..1, 0..1
    CLOUD_SPHERE1,    ///< normal numbers, three of them below 1, 2, 4 in length
    CLOUD_SPHERE2,
    CLOUD_SPHERE4,
    CLOUD_ELLIPSE,            ///< uniform where x^2 / 4 + y^2 + z^2 <= 1
    CLOUD_COUNT,              ///< of the thesis' kinds
    CLOUD_SHELL = CLOUD_COUNT ///< uniform on a sphere
};

/// As the tables call it.
const char *cloud_name(enum cloud cloud);

/// 25 * 2^step points, step 0 up to this: the sizes that the thesis ran the kind at.
uint32_t cloud_steps(enum cloud cloud);

/// A 1 of the thesis is so many units; no coordinate is above 2^29.
#define CLOUD_UNIT 0x1p27

/// A random number that depends on kind, size, case and purpose only, never 0: so any case can be
/// drawn alone.
uint64_t cloud_seed(enum cloud cloud, uint32_t count, uint32_t index);

/// One normal number by Box and Muller's method as the thesis prints it. random: its state; spare:
/// the second of each two, NAN for none.
double cloud_normal(uint64_t *random, double *spare);

/// The points of one case.
void cloud_draw(enum cloud cloud, uint32_t count, uint32_t index, struct vec3 *out);

#endif

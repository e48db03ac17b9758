/// The firmware's searches with workspaces of their own, for up to LEVINE_COUNT_MOST points.
#ifndef BENCH_LEVINE_SEARCH_H
#define BENCH_LEVINE_SEARCH_H

#include "solid/solid_sphere.h"

struct solid_hull search_hull(const struct vec3 *points, uint32_t count,
                              enum solid_hull_method method);

/// solid_sphere_by_trial.
enum solid_sphere_status search_sphere(const struct vec3 *points, uint32_t count,
                                       enum solid_sphere_order order, uint32_t place_most,
                                       struct solid_sphere *out);

/// The thesis' "expected spheres": half of all through two, three and four of n points.
double search_expected(double n);

#endif

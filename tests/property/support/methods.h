/// Every method of the narrowest cone behind one signature.
#ifndef SUPPORT_METHODS_H
#define SUPPORT_METHODS_H

#include "sphere/cone.h"

#include <stdbool.h>

#define METHODS_COUNT_MAX 2000

struct solve_method {
    const char *name;
    bool exact; ///< its support is right for the true directions, without any rounding
    enum cone_status (*solve)(const struct vec3 *points, uint32_t count,
                              struct cone_result *result);
};

extern const struct solve_method methods[];
/// Algorithms A and B are there with each construction of the diagram.
enum {
    METHOD_PIVOT,
    METHOD_SHRINK,
    METHOD_PYRAMID,
    METHOD_VORONOI,
    METHOD_VORONOI_MERGED,
    METHOD_HULL_VORONOI,
    METHOD_HULL_VORONOI_MERGED,
    METHOD_COUNT
};

/// Checks (check.h) what each says of a workspace that is too small.
void methods_check_capacities(void);

#endif

/// The methods that stand beside the default for comparison (solid_hull.h). The set spans space.
#ifndef SOLID_HULL_METHODS_H
#define SOLID_HULL_METHODS_H

#include "solid/extremes.h"
#include "solid/mesh.h"
#include "solid/solid_hull.h"

/// Leaves the hull in the mesh. Source: Levine 1975, chapter IV.D, with every tie broken by
/// side_order, so that each point that enters is a vertex of the hull.
void hull_levine(struct mesh *mesh, const struct extremes *extremes);

/// Fills result; the mesh lends its workspace. A face with more than three corners is found whole.
/// Source: Chand and Kapur 1970, as Levine 1975, chapter IV.A, tells it.
void hull_wrap(struct mesh *mesh, struct solid_hull *result);

#endif

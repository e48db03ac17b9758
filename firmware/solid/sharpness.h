/// How sharp is the hull at a vertex? The solid angle, as Levine 1975, chapter V, step 1.
#ifndef SOLID_SHARPNESS_H
#define SOLID_SHARPNESS_H

#include "solid/solid_hull.h"

/// The vertices of the hull, sharpest first; ties by index.
/// order:    gets hull->vertex_count indices. angle: of count elements, and neighbour: of count
///           elements; both are overwritten.
/// Accuracy: each angle within about 2^-28 of a sphere's; only an order hangs on it. The sum of
///           tan(E/2) = det(a, b, c) / (1 + a.b + b.c + c.a) over the triangles of a fan equals the
///           sum of l'Huilier's formula.
void sharpness_sort(const struct vec3 *points, uint32_t count, const struct solid_hull *hull,
                    int64_t *angle, uint32_t *neighbour, uint32_t *order);

#endif

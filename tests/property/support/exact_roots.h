/// Signs of polynomials of unit vectors along int32 vectors, by reals of 1,200 bits. Shares no code
/// with firmware/. A sum of four square roots of integers below 2^254 is zero or at least 2^-903:
/// the product of its eight conjugates is an integer, and each is below 2^129.
#ifndef SUPPORT_EXACT_ROOTS_H
#define SUPPORT_EXACT_ROOTS_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Sign of det(b - a, c - a, d - a) of the unit vectors.
int exact_plane_sign(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d);

/// Sign of (x - a) . (x - b) of the unit vectors.
int exact_cap_sign(struct vec3 a, struct vec3 b, struct vec3 x);

/// Sign of the distance a b minus the distance c d.
int exact_distance_cmp(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 d);

/// The normal (b - a) x (c - a) of the unit vectors, rounded to Q1.30. False: it is zero.
bool exact_circle_axis(struct vec3 a, struct vec3 b, struct vec3 c, struct vec3 *axis_q30);

/// The middle of the arc from a to b, the same way.
bool exact_middle(struct vec3 a, struct vec3 b, struct vec3 *axis_q30);

/// Do these one to three points hold the narrowest cone of the set? By its definition.
bool exact_holds_cone(const struct vec3 *points, uint32_t count, const uint32_t *support,
                      unsigned support_count);

/// Gives back what this file keeps.
void exact_roots_free(void);

#endif

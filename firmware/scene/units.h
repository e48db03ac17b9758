/// Micrometres in whole units of a scene, without a division a place.
///
/// A unit of a tree is any length (tree_header.unit_double, here in metres); a scene of towns has
/// units of metres, one of a desk of micrometres. Shapes may be enlarged by a power of two, which
/// keeps flat what is flat, so that places between them can be told apart as finely as they shall.
/// Shown: tests/unit/test_units.c.
#ifndef SCENE_UNITS_H
#define SCENE_UNITS_H

#include "fixed/must_check.h"
#include "scene/tree.h"

#include <stdbool.h>
#include <stdint.h>

/// Units a micrometre: multiplier / 2^shift.
struct units {
    uint64_t multiplier; ///< above 2^62
    uint32_t shift;      ///< above 0
};

/// Units of so many micrometres: at least 1.
struct units units_of_um(uint32_t unit_um);

/// Those of a tree, `finer` powers of two finer. False: its unit is no length, or too short a one.
bool units_of_tree(const struct tree *tree, unsigned finer, struct units *out) MUST_CHECK;

/// How many powers of two finer the shapes of a tree can be at most: up to SHAPE_COORDINATE_MAX,
/// and to a unit of 1/8 mm or less. 0 if they do not fit as they are.
unsigned units_finer(const struct tree *tree);

/// Rounded toward 0; what is beyond 2^62 units is as many.
/// Accuracy: too long by at most 2^-42 of the length, never too short: whole units stay whole.
int64_t units_from_um(struct units units, int64_t um);

#endif

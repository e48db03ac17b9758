/// What a regular projection is, by its definition: every pair, triple and quadruple, in integers
/// of any size (GMP). Shares nothing with firmware/regular/ but the shapes of its input.
#ifndef TESTS_PROPERTY_SUPPORT_REGULAR_CHECK_H
#define TESTS_PROPERTY_SUPPORT_REGULAR_CHECK_H

#include "regular/regular.h"

#include <gmp.h>

struct check_vector {
    mpz_t at[3];
};

void check_vector_init(struct check_vector *v);
void check_vector_clear(struct check_vector *v);
void check_vector_set(struct check_vector *v, struct vec3_i128 from);
void check_vector_set_small(struct check_vector *v, int64_t x, int64_t y, int64_t z);

/// Is the projection along v (POINTS3_X: onto v) free of conflicts? Not for POINTS3_XY, _XYZ.
bool check_direction(const struct regular_input *input, const struct check_vector *v);

/// The same of the axes: the rows of POINTS3_XY and _XYZ, which must be orthogonal, of equal length
/// and right-handed.
bool check_axes(const struct regular_input *input, const struct check_vector rows[3]);

/// As the input stands: along z, in the plane along y; onto the axes.
bool check_as_given(const struct regular_input *input);

/// Do these items alone, ascending, have no regular projection along z as they stand?
bool check_conflict(const struct regular_input *input, const struct regular_conflict *conflict);

/// Does a regular projection exist: no three points, no two segments on one line?
bool check_exists(const struct regular_input *input);

/// A random input: count items with coordinates within +-size, no item twice, none degenerate.
/// False: not found within a thousand draws an item.
bool check_draw(uint64_t *seed, enum regular_problem problem, uint32_t count, int32_t size,
                struct vec3 *points);

const char *check_problem_name(enum regular_problem problem);

#endif

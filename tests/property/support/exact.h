/// Signs of exact integers over int32 vectors by GMP, and the check of a witness.
#ifndef SUPPORT_EXACT_H
#define SUPPORT_EXACT_H

#include "fixed/vec3.h"

#include <stdbool.h>
#include <stdint.h>

/// Sign of det(a, b, c).
int exact_det_sign(struct vec3 a, struct vec3 b, struct vec3 c);

/// Sign of a . b.
int exact_dot_sign(struct vec3 a, struct vec3 b);

/// Is a x b zero?
bool exact_parallel(struct vec3 a, struct vec3 b);

/// NULL if `witness` names one to four different points, ascending, that sum to zero with weights
/// that are all positive; else what is wrong.
const char *exact_check_witness(const struct vec3 *points, uint32_t count, const uint32_t *witness,
                                unsigned witness_count);

/// Gives back what this file keeps.
void exact_free(void);

#endif

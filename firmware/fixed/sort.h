/// Sorts a list of indices.
#ifndef FIXED_SORT_H
#define FIXED_SORT_H

#include <stdbool.h>
#include <stdint.h>

/// Does a come strictly before b? A strict weak order.
typedef bool sort_before(const void *context, uint32_t a, uint32_t b);

/// Bottom-up merge sort, stable: count log2 count comparisons at most. spare: as large as the list.
void sort_indices(uint32_t *list, uint32_t *spare, uint32_t count, sort_before *before,
                  const void *context);

#endif

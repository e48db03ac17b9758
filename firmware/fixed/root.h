/// Integer square roots, rounded down. Exact for every input.
/// Shown: tests/unit/test_fixed.c (every boundary n^2-1, n^2, n^2+1 of a sample, and all 32-bit
/// inputs in tests/property/fixed_exhaustive.c). Source: Zimmermann, "Karatsuba Square Root", 1999:
/// each size is one division on top of the half size.
#ifndef FIXED_ROOT_H
#define FIXED_ROOT_H

#include "fixed/wide.h"

#include <stdint.h>

/// floor(sqrt(value)). Cost: two 32-bit divisions.
uint32_t root_u32(uint32_t value);

/// floor(sqrt(value)). Cost: root_u32 and one 32-bit division.
uint32_t root_u64(uint64_t value);

/// floor(sqrt(value)). Cost: root_u64 and one 64-bit division.
uint64_t root_u128(struct u128 value);

#endif

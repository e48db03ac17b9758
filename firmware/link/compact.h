/// A direction in six characters: how 64 targets fit 20 times a second through 115,200 baud.
///
/// Pan in three characters and tilt in three, each character six bits from `0` (0) to `o` (63), the
/// highest first. Pan counts 2^-18 turns clockwise from north, seen from above; tilt is signed and
/// counts 2^-19 turns up from the horizon, with 2^17 added.
/// Accuracy: half a step, 0.0007 degrees of pan and 0.00035 of tilt; straight up one step of tilt.
/// Shown: tests/unit/test_compact.c.
#ifndef LINK_COMPACT_H
#define LINK_COMPACT_H

#include "fixed/bam32.h"
#include "fixed/must_check.h"
#include "link/text.h"

#include <stdbool.h>

#define COMPACT_CHARACTERS 6U

/// tilt: within a quarter turn of 0.
void compact_write(struct text *text, bam32_t pan, bam32_t tilt);

/// Reads six characters. False: one of them is none of these.
bool compact_read(const char *characters, bam32_t *pan, bam32_t *tilt) MUST_CHECK;

#endif

/// The forbidden circles of a problem, one after the other. For the files of regular/ only.
#ifndef REGULAR_CIRCLES_H
#define REGULAR_CIRCLES_H

#include "regular/regular.h"

/// Takes the normal of a forbidden circle (components below 2^43, not 0) and the items that make
/// it. False: no more, please.
typedef bool circles_visit(void *context, struct vec3_i64 normal, uint8_t item_count,
                           const uint32_t *items);

/// POINTS3_X: pairs of points; POINTS3_PLANE: triples; SEGMENTS3_PLANE: pairs of segments that lie
/// in one plane; FACES_VERTICAL: faces.
/// Returns:  false where three points or two segments lie on one line: conflict tells.
/// Cost:     a plane for each pair, triple or face: *planes gets how many.
bool circles_each(const struct regular_input *input, circles_visit *visit, void *context,
                  struct regular_conflict *conflict, uint64_t *planes);

#endif

/// What optimize lays out beside the steps' own arrays. For the files of regular/ only.
#ifndef REGULAR_OPTIMUM_H
#define REGULAR_OPTIMUM_H

#include "regular/arrangement.h"
#include "regular/circles.h"
#include "regular/cylinder.h"
#include "regular/empty.h"
#include "regular/gap.h"
#include "regular/steps.h"

struct optimum {
    uint32_t line_room;
    struct vec3 *lines; ///< forbidden directions, primitive
    uint32_t *weights;  ///< of lines
    uint32_t line_count;
    struct lone lone; ///< lines on no circle, of SEGMENTS3_PLANE
    struct gap gap;
    struct empty empty;
    uint32_t circle_room;
    struct vec3_i64 *normals; ///< forbidden circles, primitive, as they come
    uint32_t normal_count;
    uint32_t *list, *spare;
    struct cell_circle *circles; ///< different ones
    uint32_t circle_count;
    struct arrangement arrangement;
    struct cylinder cylinder;
    bool vertical; ///< `above`: a vertical plane is in the way
    struct regular_conflict conflict;
};

void optimum_open(struct optimum *optimum, enum regular_problem problem, uint32_t count,
                  const struct regular_options *options, struct arena *arena);

enum regular_status optimum_find(struct steps *steps, struct optimum *optimum);

#endif

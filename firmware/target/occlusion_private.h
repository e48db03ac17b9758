/// Between the files of occlusion.h only.
#ifndef TARGET_OCCLUSION_PRIVATE_H
#define TARGET_OCCLUSION_PRIVATE_H

#include "target/occlusion.h"

/// Units: beyond every shape.
#define OCCLUSION_REACH (INT64_C(1) << 30)

/// Where a target of kind TARGET_POSITION is at a time, as it moves.
struct vec3_i64 occlusion_position_at(const struct occlusion_target *target, uint64_t at_us);

/// How far it gets in this time; after 16 s nothing goes on.
struct vec3_i64 occlusion_travel(struct vec3_i64 velocity_ump20, uint64_t elapsed_us);

/// Begins a look at everything as it is at now_us.
void occlusion_look_begin(struct occlusion *occlusion, uint64_t now_us);

/// A unit of the look that runs. False: it is over.
bool occlusion_look_work(struct occlusion *occlusion, uint64_t now_us);

/// The target of that index is another one now, or none.
void occlusion_look_without(struct occlusion *occlusion, uint32_t index);

#endif

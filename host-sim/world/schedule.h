/// What happens to the targets, and when: a list of timed updates, and targets that move by a
/// formula.
///
/// The same list feeds the controller (through the pump, as a source would) and the truth that the
/// simulator measures against.
#ifndef WORLD_SCHEDULE_H
#define WORLD_SCHEDULE_H

#include "target/target_set.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct schedule_item {
    uint64_t at_us;
    struct target_update update;
    double size;    ///< of its dot in a picture, about 0.2 to 5
    char label[24]; ///< may be empty
};

/// A subject: what the targets from some time on are called, for progress and pictures.
struct schedule_subject {
    uint64_t at_us;
    char name[48];
};

/// A target that moves: start + velocity * t + radius * (cos, sin)(phase + rate * t) in the
/// horizontal plane. The controller hears of it every period_us, the truth knows it at every tick.
struct schedule_mover {
    uint32_t id;
    uint16_t object;
    uint64_t from_us, until_us; ///< until_us 0: for ever
    uint32_t period_us;
    double start_m[3], velocity_mps[3];
    double radius_m, phase_rad, rate_rps;
    double noise_m; ///< standard deviation of what the controller hears, each component
};

struct schedule {
    const char *noun;            ///< what the targets are: "stars"; NULL: "targets"
    struct schedule_item *items; ///< ascending in time
    size_t item_count, item_capacity;
    struct schedule_subject *subjects;
    size_t subject_count, subject_capacity;
    struct schedule_mover *movers;
    size_t mover_count, mover_capacity;
    struct schedule_item *background; ///< directions for the pictures only
    size_t background_count, background_capacity;
};

void schedule_init(struct schedule *schedule);
void schedule_free(struct schedule *schedule);

/// Each appends a copy. Items must come in the order of their times. False: out of memory.
bool schedule_add(struct schedule *schedule, const struct schedule_item *item);
bool schedule_add_subject(struct schedule *schedule, uint64_t at_us, const char *name);
bool schedule_add_mover(struct schedule *schedule, const struct schedule_mover *mover);
bool schedule_add_background(struct schedule *schedule, const struct schedule_item *item);

/// Where the mover is at a time.
struct vec3_i64 schedule_mover_position_um(const struct schedule_mover *mover, uint64_t at_us);

#endif

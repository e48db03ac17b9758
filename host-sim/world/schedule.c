#include "world/schedule.h"

#include "plant/axis_plant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void schedule_init(struct schedule *schedule) {
    memset(schedule, 0, sizeof *schedule);
}

void schedule_free(struct schedule *schedule) {
    free(schedule->items);
    free(schedule->subjects);
    free(schedule->movers);
    free(schedule->background);
    schedule_init(schedule);
}

/// Appends size bytes at `from` to a growing array.
static bool append(void **array, size_t *count, size_t *capacity, const void *from, size_t size) {
    if (*count == *capacity) {
        const size_t larger = *capacity == 0U ? 64U : 2U * *capacity;
        void *moved = realloc(*array, larger * size);
        if (moved == NULL) {
            return false;
        }
        *array = moved;
        *capacity = larger;
    }
    memcpy((char *)*array + *count * size, from, size);
    (*count)++;
    return true;
}

bool schedule_add(struct schedule *schedule, const struct schedule_item *item) {
    return append((void **)&schedule->items, &schedule->item_count, &schedule->item_capacity, item,
                  sizeof *item);
}

bool schedule_add_subject(struct schedule *schedule, uint64_t at_us, const char *name) {
    struct schedule_subject subject = {.at_us = at_us};
    snprintf(subject.name, sizeof subject.name, "%s", name);
    return append((void **)&schedule->subjects, &schedule->subject_count,
                  &schedule->subject_capacity, &subject, sizeof subject);
}

bool schedule_add_mover(struct schedule *schedule, const struct schedule_mover *mover) {
    return append((void **)&schedule->movers, &schedule->mover_count, &schedule->mover_capacity,
                  mover, sizeof *mover);
}

bool schedule_add_background(struct schedule *schedule, const struct schedule_item *item) {
    return append((void **)&schedule->background, &schedule->background_count,
                  &schedule->background_capacity, item, sizeof *item);
}

/// To whole micrometres, half away from zero; without libm, whose last bits differ between systems.
static int64_t to_um(double metres) {
    const double um = metres * 1e6;
    return um >= 0.0 ? (int64_t)(um + 0.5) : -(int64_t)(0.5 - um);
}

struct vec3_i64 schedule_mover_position_um(const struct schedule_mover *mover, uint64_t at_us) {
    const double t = (double)(int64_t)(at_us - mover->from_us) * 1e-6;
    const double phase = mover->phase_rad + mover->rate_rps * t;
    const double quarter = AXIS_PLANT_PI / 2.0;
    return (struct vec3_i64){to_um(mover->start_m[0] + mover->velocity_mps[0] * t +
                                   mover->radius_m * axis_plant_cos(phase)),
                             to_um(mover->start_m[1] + mover->velocity_mps[1] * t +
                                   mover->radius_m * axis_plant_cos(phase - quarter)),
                             to_um(mover->start_m[2] + mover->velocity_mps[2] * t)};
}

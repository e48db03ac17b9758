#include "target/target_set.h"

#include "fixed/root.h"
#include "fixed/trig.h"

static uint32_t home_slot(uint32_t id) {
    return (id * UINT32_C(2654435761)) >> 23; // Fibonacci hashing to 9 bits
}

static uint32_t next_slot(uint32_t slot) {
    return (slot + 1U) % TARGET_INDEX_SIZE;
}

/// The slot that holds the id, or the empty one where it belongs. Ends: the index is never more
/// than half full.
static uint32_t find_slot(const struct target_set *set, uint32_t id) {
    uint32_t slot = home_slot(id);
    while (set->slot[slot] != 0U && set->target[set->slot[slot] - 1U].id != id) {
        slot = next_slot(slot);
    }
    return slot;
}

/// Empties a slot and moves later ones of the same run up, so that no search ends early.
static void free_slot(struct target_set *set, uint32_t slot) {
    uint32_t gap = slot;
    for (uint32_t at = next_slot(slot); set->slot[at] != 0U; at = next_slot(at)) {
        const uint32_t home = home_slot(set->target[set->slot[at] - 1U].id);
        const uint32_t from_home = (at - home) % TARGET_INDEX_SIZE;
        if (from_home >= (at - gap) % TARGET_INDEX_SIZE) {
            set->slot[gap] = set->slot[at];
            gap = at;
        }
    }
    set->slot[gap] = 0;
}

static void clear(struct target_set *set) {
    set->version += set->count != 0U;
    set->count = set->moving_count = set->sized_count = set->muted_count = 0;
    for (uint32_t slot = 0; slot < TARGET_INDEX_SIZE; slot++) {
        set->slot[slot] = 0;
    }
}

/// The counts forget the target at `place`.
static void leave(struct target_set *set, uint32_t place) {
    set->sized_count -= set->target[place].radius_bam32 != 0U;
    set->muted_count -= set->target[place].weight_q16 == 0U;
}

/// Takes the target at `place` out; the last one takes its place.
static void remove_at(struct target_set *set, uint32_t place) {
    const uint32_t last = set->count - 1U;
    set->moving_count -= set->target[place].moves;
    leave(set, place);
    free_slot(set, find_slot(set, set->target[place].id));
    if (place != last) {
        set->slot[find_slot(set, set->target[last].id)] = (uint16_t)(place + 1U);
        set->target[place] = set->target[last];
        set->direction_q30[place] = set->direction_q30[last];
        set->radius[place] = set->radius[last];
    }
    set->count = last;
    set->version++;
}

void target_set_init(struct target_set *set, struct vec3_i64 viewpoint_um, uint64_t expiry_us) {
    set->version = set->rest_reports = 0;
    set->count = 0;
    set->viewpoint_um = viewpoint_um;
    set->expiry_us = expiry_us;
    set->oldest_us = 0;
    clear(set);
}

static bool in_range(int64_t coordinate) {
    return coordinate <= TARGET_POSITION_UM_MAX && coordinate >= -TARGET_POSITION_UM_MAX;
}

/// Direction and angular radius of a sphere in the world, seen from the viewpoint.
static enum target_status see_position(const struct target_set *set,
                                       const struct target_update *update, struct vec3 *seen_q30,
                                       uint32_t *radius_bam32) {
    const struct vec3_i64 position = update->position_um;
    if (!in_range(position.x) || !in_range(position.y) || !in_range(position.z)) {
        return TARGET_ERROR_RANGE;
    }
    const struct vec3_i64 offset = vec3_i64_sub(position, set->viewpoint_um);
    *seen_q30 = vec3_i64_normalise(offset);
    *radius_bam32 = 0;
    if (update->radius_um == 0U) {
        return vec3_is_zero(*seen_q30) ? TARGET_ERROR_VIEWPOINT : TARGET_OK;
    }
    // The cone that touches the sphere: opposite side radius, adjacent side the tangent,
    // sqrt(distance^2 - radius^2).
    const uint64_t radius = update->radius_um;
    const struct i128 tangent2 =
        i128_sub(vec3_i64_dot(offset, offset), (struct i128){radius * radius, 0});
    if (i128_sign(tangent2) <= 0) {
        return TARGET_ERROR_VIEWPOINT;
    }
    const uint64_t tangent = root_u128((struct u128){tangent2.lo, (uint64_t)tangent2.hi});
    *radius_bam32 = trig_atan2((int64_t)radius, (int64_t)tangent).bam + 1U;
    return TARGET_OK;
}

static enum target_status see_direction(const struct target_update *update, struct vec3 *seen_q30,
                                        uint32_t *radius_bam32) {
    if (vec3_is_zero(update->direction) || update->radius_bam32 >= BAM32_QUARTER) {
        return TARGET_ERROR_RANGE;
    }
    *seen_q30 = vec3_normalise(update->direction);
    *radius_bam32 = update->radius_bam32;
    return TARGET_OK;
}

/// Writes what was seen of a target; nothing of another may be there.
static void put(struct target_set *set, uint32_t place, struct vec3 seen_q30,
                const struct target *seen) {
    const bam32_t angle = bam32(seen->radius_bam32);
    const bool sized = seen->radius_bam32 != 0U;
    const struct sincos of_angle = sized ? trig_sincos(angle) : (struct sincos){0, Q30_ONE};
    set->direction_q30[place] = seen_q30;
    set->radius[place] = (struct follow_radius){angle, of_angle.sin_q30, of_angle.cos_q30};
    set->sized_count += sized;
    set->muted_count += seen->weight_q16 == 0U;
    set->target[place] = *seen;
}

/// Takes a new report of a target. One that changes nothing needs no new solution, but tells that
/// the target has come to rest.
static void replace(struct target_set *set, uint32_t place, struct vec3 seen_q30,
                    const struct target *seen) {
    struct target *target = &set->target[place];
    const bool changed = !vec3_equal(set->direction_q30[place], seen_q30) ||
                         target->radius_bam32 != seen->radius_bam32 ||
                         target->weight_q16 != seen->weight_q16 || target->object != seen->object;
    set->moving_count += (uint32_t)changed - (uint32_t)target->moves;
    set->version += changed;
    set->rest_reports += !changed && set->moving_count == 0U;
    leave(set, place);
    put(set, place, seen_q30, seen);
    target->moves = changed;
}

/// Adds or replaces a target.
static enum target_status store(struct target_set *set, const struct target_update *update,
                                uint64_t now_us) {
    struct vec3 seen_q30;
    uint32_t radius_bam32;
    const enum target_status status = update->kind == TARGET_POSITION
                                          ? see_position(set, update, &seen_q30, &radius_bam32)
                                          : see_direction(update, &seen_q30, &radius_bam32);
    if (status != TARGET_OK) {
        return status;
    }
    const struct target seen = {.id = update->id,
                                .object = update->object,
                                .weight_q16 = update->weight_q16,
                                .radius_bam32 = radius_bam32,
                                .seen_us = now_us};
    uint32_t place;
    if (target_set_find(set, update->id, &place)) {
        replace(set, place, seen_q30, &seen);
        return TARGET_OK;
    }
    if (set->count == TARGET_CAPACITY) {
        return TARGET_ERROR_FULL;
    }
    set->oldest_us = set->count == 0U ? now_us : set->oldest_us;
    place = set->count++;
    set->slot[find_slot(set, update->id)] = (uint16_t)(place + 1U);
    put(set, place, seen_q30, &seen);
    set->version++;
    return TARGET_OK;
}

enum target_status target_set_apply(struct target_set *set, const struct target_update *update,
                                    uint64_t now_us) {
    uint32_t place;
    switch (update->kind) {
    case TARGET_POSITION:
    case TARGET_DIRECTION:
        return store(set, update, now_us);
    case TARGET_GONE:
        if (target_set_find(set, update->id, &place)) {
            remove_at(set, place);
        }
        return TARGET_OK;
    case TARGET_CLEAR:
        clear(set);
        return TARGET_OK;
    default:
        return TARGET_ERROR_RANGE;
    }
}

uint32_t target_set_expire(struct target_set *set, uint64_t now_us) {
    if (set->expiry_us == 0U || set->count == 0U || now_us - set->oldest_us <= set->expiry_us) {
        return 0;
    }
    const uint32_t before = set->count;
    set->oldest_us = now_us;
    for (uint32_t place = 0; place < set->count;) {
        const uint64_t seen_us = set->target[place].seen_us;
        if (now_us - seen_us > set->expiry_us) {
            remove_at(set, place); // and look at the one that took its place
            continue;
        }
        set->oldest_us = seen_us < set->oldest_us ? seen_us : set->oldest_us;
        place++;
    }
    return before - set->count;
}

bool target_set_find(const struct target_set *set, uint32_t id, uint32_t *place) {
    const uint32_t slot = find_slot(set, id);
    *place = set->slot[slot] == 0U ? 0U : set->slot[slot] - 1U;
    return set->slot[slot] != 0U;
}

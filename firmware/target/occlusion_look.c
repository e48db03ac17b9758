/// What is in sight, now and at each frame ahead.
#include "target/occlusion_private.h"

#include "fixed/q30.h"
#include "fixed/root.h"

#define REACH         OCCLUSION_REACH
#define Q30_HALF_ROOT 759250125 // cos 45 degrees
#define ALL_SAMPLES   ((uint16_t)((1U << OCCLUSION_SAMPLES) - 1U))
#define UNIT_BOUNDS   16U ///< no piece is begun after so many bounds in a unit of work
#define UNIT_DECIDED  4U  ///< targets

// ---------------------------------------------------------------- shadows

/// The eye that sees a group as it is without its offset: moved back. False: too far away.
static bool eye_of(const struct occlusion *o, uint32_t group, uint64_t at_us, struct vec3 *out) {
    const struct occlusion_group *const g = &o->group[group % OCCLUSION_GROUPS_MAX];
    const uint64_t us = at_us > g->since_us ? at_us - g->since_us : 0U;
    const struct vec3_i64 way = occlusion_travel(g->velocity_ump20, us);
    const struct vec3_i64 from = o->config->viewpoint_um, by = g->offset_um;
    const int64_t eye[3] = {units_from_um(o->config->units, from.x - by.x - way.x),
                            units_from_um(o->config->units, from.y - by.y - way.y),
                            units_from_um(o->config->units, from.z - by.z - way.z)};
    for (unsigned k = 0; k < 3U; k++) {
        if (eye[k] > REACH / 2 || eye[k] < -REACH / 2) {
            return false;
        }
    }
    *out = vec3((int32_t)eye[0], (int32_t)eye[1], (int32_t)eye[2]);
    return true;
}

/// The shadows with all groups where they are at a time.
static void cast_shadows(struct occlusion *o, uint64_t at_us) {
    o->sight.bound_count = o->sight.piece_count = 0;
    for (uint32_t i = 0; i < o->config->shapes->object_count; i++) {
        const uint32_t group = o->config->group == NULL ? 0U : o->config->group[i];
        if (eye_of(o, group, at_us, &o->sight.eye)) {
            (void)sight_add(&o->sight, o->config->shapes, i); // there is room: occlusion_init
        }
    }
}

static bool is_zero(struct vec3_i64 v) {
    return (v.x | v.y | v.z) == 0;
}

static bool groups_stand(const struct occlusion *o) {
    for (uint32_t g = 0; g < OCCLUSION_GROUPS_MAX; g++) {
        if (!is_zero(o->group[g].velocity_ump20)) {
            return false;
        }
    }
    return true;
}

static bool in_sight(const struct occlusion *o, struct vec3 place) {
    for (uint32_t i = 0; i < o->sight.piece_count; i++) {
        if (sight_hides(&o->sight, &o->sight.pieces[i], place)) {
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- samples

/// Relative to the viewpoint, in units. False: farther than every shape.
static bool relative(const struct occlusion *o, struct vec3_i64 position_um, struct vec3 *out) {
    const struct vec3_i64 d = vec3_i64_sub(position_um, o->config->viewpoint_um);
    const int64_t x = units_from_um(o->config->units, d.x),
                  y = units_from_um(o->config->units, d.y),
                  z = units_from_um(o->config->units, d.z);
    if (x >= REACH || x <= -REACH || y >= REACH || y <= -REACH || z >= REACH || z <= -REACH) {
        *out = vec3_i64_normalise(d); // comes nearer, in the same direction
        return false;
    }
    *out = vec3((int32_t)x, (int32_t)y, (int32_t)z);
    return true;
}

/// Where the samples of a target are: right and up across the line of sight, in parts of its
/// radius. The middle, and eight points of its rim.
static const struct {
    int32_t right_q30, up_q30;
} rim[OCCLUSION_SAMPLES] = {{0, 0},
                            {Q30_ONE, 0},
                            {Q30_HALF_ROOT, Q30_HALF_ROOT},
                            {0, Q30_ONE},
                            {-Q30_HALF_ROOT, Q30_HALF_ROOT},
                            {-Q30_ONE, 0},
                            {-Q30_HALF_ROOT, -Q30_HALF_ROOT},
                            {0, -Q30_ONE},
                            {Q30_HALF_ROOT, -Q30_HALF_ROOT}};

static bool is_point(const struct occlusion_target *t) {
    return t->last.kind == TARGET_DIRECTION || t->last.radius_um == 0U;
}

/// Right and up of a target as the viewpoint sees it.
static void find_axes(struct occlusion *o, const struct occlusion_target *t, uint64_t at_us) {
    struct occlusion_look *const look = &o->look;
    if (is_point(t)) {
        return;
    }
    const struct vec3 ahead =
        vec3_i64_normalise(vec3_i64_sub(occlusion_position_at(t, at_us), o->config->viewpoint_um));
    const bool upright = ahead.x == 0 && ahead.y == 0;
    look->right = vec3_i64_normalise(vec3_cross(ahead, upright ? vec3(1, 0, 0) : vec3(0, 0, 1)));
    look->up = vec3_i64_normalise(vec3_cross(look->right, ahead));
}

/// right * u + up * v, times a length of at most 2^32; u and v of at most 2^30 in size.
static struct vec3_i64 across(const struct occlusion_look *look, int64_t u, int64_t v,
                              int64_t length) {
    const struct vec3 r = look->right, p = look->up;
    return (struct vec3_i64){((u * r.x >> 30) + (v * p.x >> 30)) * length >> 30,
                             ((u * r.y >> 30) + (v * p.y >> 30)) * length >> 30,
                             ((u * r.z >> 30) + (v * p.z >> 30)) * length >> 30};
}

/// The samples at a time, relative to the viewpoint; the axes are of that time. Returns how many.
static uint32_t places_of(const struct occlusion *o, const struct occlusion_target *t,
                          uint64_t at_us, struct vec3 out[OCCLUSION_SAMPLES]) {
    if (t->last.kind == TARGET_DIRECTION) {
        out[0] = vec3_normalise(t->last.direction);
        return 1;
    }
    const int64_t radius = units_from_um(o->config->units, t->last.radius_um);
    if (!relative(o, occlusion_position_at(t, at_us), &out[0]) || is_point(t) || radius >= REACH) {
        return 1;
    }
    for (uint32_t k = 1; k < OCCLUSION_SAMPLES; k++) {
        const struct vec3_i64 by = across(&o->look, rim[k].right_q30, rim[k].up_q30, radius);
        out[k] = vec3((int32_t)(out[0].x + by.x), (int32_t)(out[0].y + by.y),
                      (int32_t)(out[0].z + by.z));
    }
    return OCCLUSION_SAMPLES;
}

/// A point has all of the samples or none.
static uint16_t seen_of(uint32_t count, uint16_t seen) {
    return count != 1U ? seen : seen != 0U ? ALL_SAMPLES : 0U;
}

static uint8_t count_bits(uint16_t bits) {
    uint8_t count = 0;
    for (; bits != 0U; bits &= (uint16_t)(bits - 1U)) {
        count++;
    }
    return count;
}

// ---------------------------------------------------------------- one target

/// What was seen of a target at a frame. Sets when it hides or shows, and what counts.
static void note(struct occlusion *o, struct occlusion_target *t, uint64_t ahead_us,
                 uint16_t seen) {
    const struct occlusion_settings *const s = &o->config->settings;
    const uint64_t at_us = o->look.at_us + ahead_us;
    if (ahead_us == 0U) {
        t->look.samples = seen;
        t->look.counted = 0;
        t->look.hides_us = t->look.shows_us = OCCLUSION_NEVER;
    } else if (t->look.samples != 0U && seen == 0U && t->look.hides_us == OCCLUSION_NEVER) {
        t->look.hides_us = at_us;
    } else if (t->look.samples == 0U && seen != 0U && t->look.shows_us == OCCLUSION_NEVER) {
        t->look.shows_us = at_us;
    }
    const bool matters = s->policy == OCCLUSION_DROP
                             ? ahead_us == 0U
                             : ahead_us >= s->fade_us || ahead_us + s->frame_us > s->ahead_us;
    t->look.counted |= matters ? seen : 0U;
}

/// It was the same at every frame.
static void note_always(struct occlusion *o, struct occlusion_target *t, uint16_t seen) {
    note(o, t, 0, seen);
    t->look.counted = seen;
}

/// The ball around the samples that count: their mean, and the farthest of them. The axes are of
/// now.
static void find_part(const struct occlusion *o, struct occlusion_target *t) {
    const uint16_t counted = t->look.counted;
    const int64_t count = count_bits(counted);
    int64_t u = 0, v = 0;
    uint64_t farthest2 = 0;
    if (count == 0) {
        return; // as it was: if nothing of anything is in sight, it goes on counting
    }
    t->is_part = counted != ALL_SAMPLES && !is_point(t);
    if (!t->is_part) {
        return;
    }
    for (uint32_t k = 0; k < OCCLUSION_SAMPLES; k++) {
        u += (counted >> k & 1U) != 0U ? rim[k].right_q30 : 0;
        v += (counted >> k & 1U) != 0U ? rim[k].up_q30 : 0;
    }
    u /= count;
    v /= count;
    for (uint32_t k = 0; k < OCCLUSION_SAMPLES; k++) {
        const int64_t du = rim[k].right_q30 - u, dv = rim[k].up_q30 - v;
        const uint64_t away2 = (uint64_t)(du * du) + (uint64_t)(dv * dv);
        farthest2 = (counted >> k & 1U) != 0U && away2 > farthest2 ? away2 : farthest2;
    }
    t->part_um = across(&o->look, u, v, t->last.radius_um);
    t->part_radius_um =
        (uint32_t)(((uint64_t)root_u64(farthest2) + 1U) * t->last.radius_um >> 30) + 1U;
}

static void finish_target(struct occlusion *o, struct occlusion_target *t) {
    t->look.number = o->look.number;
    o->look.any = o->look.any || t->look.counted != 0U;
    o->looked_total++;
    o->hidden_total += t->look.samples == 0U;
}

// ---------------------------------------------------------------- what counts

/// Is anything that this target is framed with in sight?
static bool any_with(const struct occlusion *o, const struct occlusion_target *t) {
    if (!o->by_object) {
        return o->look.any;
    }
    for (uint32_t i = 0; i < o->target_count; i++) {
        const struct occlusion_target *const other = &o->target[i];
        if (other->last.object == t->last.object && other->look.number == o->look.number &&
            other->look.counted != 0U) {
            return true;
        }
    }
    return false;
}

static void decide(const struct occlusion *o, struct occlusion_target *t) {
    if (t->look.number != o->look.number) {
        return; // it came while the look was on
    }
    t->samples = t->look.samples;
    t->samples_seen = count_bits(t->samples);
    t->hides_us = t->look.hides_us;
    t->shows_us = t->look.shows_us;
    if (any_with(o, t)) {
        t->counts = t->look.counted != 0U;
    }
}

// ---------------------------------------------------------------- the look

/// With groups that move: the shadows of each frame, and all targets in them.
static void look_at_moving(struct occlusion *o) {
    const struct occlusion_settings *const s = &o->config->settings;
    const uint64_t end_us = o->target_count != 0U ? s->ahead_us + 1U : 0U;
    for (uint64_t ahead_us = 0; ahead_us < end_us; ahead_us += s->frame_us) {
        cast_shadows(o, o->look.at_us + ahead_us);
        for (uint32_t i = 0; i < o->target_count; i++) {
            struct vec3 place[OCCLUSION_SAMPLES];
            uint16_t seen = 0;
            find_axes(o, &o->target[i], o->look.at_us + ahead_us);
            const uint32_t count = places_of(o, &o->target[i], o->look.at_us + ahead_us, place);
            for (uint32_t k = 0; k < count; k++) {
                seen |= in_sight(o, place[k]) ? (uint16_t)(1U << k) : 0U;
            }
            note(o, &o->target[i], ahead_us, seen_of(count, seen));
        }
    }
    for (uint32_t i = 0; i < o->target_count; i++) {
        find_axes(o, &o->target[i], o->look.at_us);
        find_part(o, &o->target[i]);
        finish_target(o, &o->target[i]);
    }
    o->cast = false;
}

static void begin_target(struct occlusion_look *look) {
    look->stage = OCCLUSION_LOOK_NEAR;
    look->started = false;
}

void occlusion_look_begin(struct occlusion *o, uint64_t now_us) {
    struct occlusion_look *const look = &o->look;
    look->runs = true;
    look->any = false;
    look->number++;
    look->at_us = now_us;
    look->target = 0;
    begin_target(look);
    if (o->config->shapes != NULL && !groups_stand(o)) {
        look_at_moving(o);
        look->stage = OCCLUSION_LOOK_DECIDE;
    } else if (o->config->shapes != NULL && !o->cast) {
        cast_shadows(o, now_us);
        o->cast = true;
    }
}

void occlusion_look_without(struct occlusion *o, uint32_t index) {
    if (o->look.target == index && o->look.stage != OCCLUSION_LOOK_DECIDE) {
        begin_target(&o->look);
    }
}

static bool stands(const struct occlusion_target *t) {
    return t->last.kind == TARGET_DIRECTION || is_zero(t->velocity_ump20);
}

/// The ball in which the target is all the time ahead; too large a one: every piece is near.
static void find_ball(struct occlusion *o, const struct occlusion_target *t) {
    struct occlusion_look *const look = &o->look;
    struct vec3 from, to;
    look->piece = look->near_count = 0;
    look->all_near = true;
    if (t->last.kind == TARGET_DIRECTION ||
        !relative(o, occlusion_position_at(t, look->at_us), &from) ||
        !relative(o, occlusion_position_at(t, look->at_us + o->config->settings.ahead_us), &to)) {
        return;
    }
    const struct vec3_i64 way = {(int64_t)to.x - from.x, (int64_t)to.y - from.y,
                                 (int64_t)to.z - from.z};
    const int64_t radius = (int64_t)(vec3_i64_length(way) / 2U) +
                           units_from_um(o->config->units, t->last.radius_um) + 4;
    if (radius < REACH) {
        look->all_near = false;
        look->ball =
            vec3((int32_t)(((int64_t)from.x + to.x) / 2), (int32_t)(((int64_t)from.y + to.y) / 2),
                 (int32_t)(((int64_t)from.z + to.z) / 2));
        look->ball_radius = (uint32_t)radius;
    }
}

static void go_to_frame(struct occlusion_look *look, uint64_t ahead_us) {
    look->stage = OCCLUSION_LOOK_AXES;
    look->ahead_us = ahead_us;
}

static void find_near(struct occlusion *o, struct occlusion_target *t) {
    struct occlusion_look *const look = &o->look;
    if (!look->started) {
        look->started = true;
        find_ball(o, t);
        return;
    }
    for (uint32_t work = 0; !look->all_near && look->piece < o->sight.piece_count; look->piece++) {
        const struct sight_piece *const piece = &o->sight.pieces[look->piece];
        if (work >= UNIT_BOUNDS) {
            return;
        }
        work += piece->count;
        if (sight_may_hide(&o->sight, piece, look->ball, look->ball_radius)) {
            look->all_near = look->near_count == OCCLUSION_NEAR_MAX || look->piece > UINT16_MAX;
            if (!look->all_near) {
                look->near[look->near_count++] = (uint16_t)look->piece;
            }
        }
    }
    go_to_frame(look, 0);
    if (!look->all_near && look->near_count == 0U) {
        note_always(o, t, ALL_SAMPLES);
        look->stage = OCCLUSION_LOOK_PART; // all of it: no axes are asked for
    }
}

/// The last one; then comes what is made of it all.
static void leave_frames(struct occlusion_look *look, const struct occlusion_target *t) {
    look->stage = is_point(t) ? OCCLUSION_LOOK_PART : OCCLUSION_LOOK_PART_AXES;
}

static void place_samples(struct occlusion *o, const struct occlusion_target *t) {
    struct occlusion_look *const look = &o->look;
    look->sample_count = places_of(o, t, look->at_us + look->ahead_us, look->place);
    look->sample = look->piece = 0;
    look->seen = 0;
    look->stage = OCCLUSION_LOOK_TEST;
}

/// All samples of a frame were tested.
static void finish_frame(struct occlusion *o, struct occlusion_target *t) {
    struct occlusion_look *const look = &o->look;
    const struct occlusion_settings *const s = &o->config->settings;
    const uint16_t seen = seen_of(look->sample_count, look->seen);
    if (stands(t)) {
        note_always(o, t, seen);
        leave_frames(look, t);
        return;
    }
    note(o, t, look->ahead_us, seen);
    go_to_frame(look, look->ahead_us + s->frame_us);
    if (look->ahead_us > s->ahead_us) {
        leave_frames(look, t);
    }
}

static void test_samples(struct occlusion *o, struct occlusion_target *t) {
    struct occlusion_look *const look = &o->look;
    const uint32_t count = look->all_near ? o->sight.piece_count : look->near_count;
    for (uint32_t work = 0; look->sample < look->sample_count;) {
        if (look->piece == count) {
            look->seen |= (uint16_t)(1U << look->sample++);
            look->piece = 0;
            continue;
        }
        const struct sight_piece *const piece =
            &o->sight.pieces[look->all_near ? look->piece : look->near[look->piece]];
        if (work >= UNIT_BOUNDS) {
            return;
        }
        work += piece->count;
        look->piece++;
        if (sight_hides(&o->sight, piece, look->place[look->sample])) {
            look->sample++;
            look->piece = 0;
        }
    }
    finish_frame(o, t);
}

/// Some targets. False: all are decided.
static bool decide_some(struct occlusion *o, uint64_t now_us) {
    struct occlusion_look *const look = &o->look;
    for (uint32_t i = 0; i < UNIT_DECIDED && look->target < o->target_count; i++) {
        decide(o, &o->target[look->target++]);
    }
    if (look->target < o->target_count) {
        return true;
    }
    look->runs = false;
    o->look_us = (uint32_t)(now_us - look->at_us);
    return false;
}

bool occlusion_look_work(struct occlusion *o, uint64_t now_us) {
    struct occlusion_look *const look = &o->look;
    if (look->stage == OCCLUSION_LOOK_DECIDE) {
        return decide_some(o, now_us);
    }
    if (look->target >= o->target_count) {
        look->stage = OCCLUSION_LOOK_DECIDE;
        look->target = 0;
        return true;
    }
    struct occlusion_target *const t = &o->target[look->target];
    switch (look->stage) {
    case OCCLUSION_LOOK_NEAR:
        find_near(o, t);
        break;
    case OCCLUSION_LOOK_AXES:
        find_axes(o, t, look->at_us + look->ahead_us);
        look->stage = OCCLUSION_LOOK_PLACE;
        break;
    case OCCLUSION_LOOK_PLACE:
        place_samples(o, t);
        break;
    case OCCLUSION_LOOK_TEST:
        test_samples(o, t);
        break;
    case OCCLUSION_LOOK_PART_AXES:
        find_axes(o, t, look->at_us);
        look->stage = OCCLUSION_LOOK_PART;
        break;
    default:
        find_part(o, t);
        finish_target(o, t);
        look->target++;
        begin_target(look);
        break;
    }
    return true;
}

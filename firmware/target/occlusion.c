#include "target/occlusion.h"

#define Q30_HALF_ROOT ((int64_t)759250125) // cos 45 degrees
#define REACH         (INT64_C(1) << 30)   // units: beyond every shape

size_t occlusion_workspace_bytes(const struct shape_set *shapes) {
    return SIGHT_BOUNDS_MAX(shapes->face_count, shapes->edge_count, shapes->corner_count) *
               sizeof(struct sight_bound) +
           ((size_t)shapes->object_count + shapes->face_count) * sizeof(struct sight_piece);
}

static bool is_near(int64_t um, uint32_t unit_um) {
    return um / unit_um <= SHAPE_COORDINATE_MAX && um / unit_um >= -SHAPE_COORDINATE_MAX;
}

bool occlusion_init(struct occlusion *o, const struct occlusion_config *config, void *workspace,
                    size_t workspace_bytes) {
    const struct shape_set *const shapes = config->shapes;
    const size_t bounds =
        SIGHT_BOUNDS_MAX(shapes->face_count, shapes->edge_count, shapes->corner_count);
    if (workspace_bytes < occlusion_workspace_bytes(shapes) || config->unit_um < 1U ||
        config->unit_um > 1000000U || config->frame_us < 1000U || config->frame_us > 1000000U ||
        config->fade_us > config->ahead_us || !is_near(config->viewpoint_um.x, config->unit_um) ||
        !is_near(config->viewpoint_um.y, config->unit_um) ||
        !is_near(config->viewpoint_um.z, config->unit_um) ||
        config->ahead_us / config->frame_us > OCCLUSION_FRAMES_MAX) {
        return false;
    }
    *o = (struct occlusion){.config = config};
    o->sight.bounds = workspace;
    o->sight.bound_room = (uint32_t)bounds;
    o->sight.pieces = (struct sight_piece *)(void *)(o->sight.bounds + bounds);
    o->sight.piece_room = shapes->object_count + shapes->face_count;
    return true;
}

// ---------------------------------------------------------------- reports

/// The index of a target; target_count: it is not known.
static uint32_t find(const struct occlusion *o, uint32_t id) {
    uint32_t i = 0;
    while (i < o->target_count && o->target[i].last.id != id) {
        i++;
    }
    return i;
}

/// Micrometres a second; 1000 km/s and more is no motion but another place.
static int64_t rate(int64_t from, int64_t to, uint64_t elapsed_us) {
    const int64_t most = INT64_C(1000000000000), way = to - from;
    const int64_t velocity = way < most && way > -most ? way * 1000000 / (int64_t)elapsed_us : most;
    return velocity < most && velocity > -most ? velocity : 0;
}

/// The mean of the last few velocities; the first one as it is.
static void take_velocity(struct occlusion_target *t, const struct target_update *update,
                          uint64_t now_us) {
    const uint64_t elapsed_us = now_us - t->seen_us;
    if (t->last.kind != TARGET_POSITION || update->kind != TARGET_POSITION || elapsed_us == 0U) {
        return;
    }
    const struct vec3_i64 a = t->last.position_um, b = update->position_um;
    const struct vec3_i64 fresh = {rate(a.x, b.x, elapsed_us), rate(a.y, b.y, elapsed_us),
                                   rate(a.z, b.z, elapsed_us)};
    struct vec3_i64 *const v = &t->velocity_umps;
    const bool first = t->reports == 1U;
    v->x = first ? fresh.x : v->x + (fresh.x - v->x) / 8;
    v->y = first ? fresh.y : v->y + (fresh.y - v->y) / 8;
    v->z = first ? fresh.z : v->z + (fresh.z - v->z) / 8;
}

bool occlusion_report(struct occlusion *o, const struct target_update *update, uint64_t now_us) {
    const uint32_t index = find(o, update->id);
    const bool known = index < o->target_count;
    if (update->kind == TARGET_CLEAR) {
        o->target_count = 0;
        return false; // the controller clears, too
    }
    if (update->kind == TARGET_GONE) {
        if (known) {
            o->target[index] = o->target[--o->target_count];
        }
        return false;
    }
    if (!known && o->target_count == OCCLUSION_TARGETS_MAX) {
        return false;
    }
    struct occlusion_target *const t = &o->target[index];
    if (known) {
        take_velocity(t, update, now_us);
    } else {
        o->target_count++;
        *t = (struct occlusion_target){
            .counts = true, .hides_us = OCCLUSION_NEVER, .shows_us = OCCLUSION_NEVER};
    }
    t->last = *update;
    t->seen_us = now_us;
    t->reports++;
    return true;
}

void occlusion_move(struct occlusion *o, uint32_t group, struct vec3_i64 offset_um,
                    struct vec3_i64 velocity_umps, uint64_t now_us) {
    if (group < OCCLUSION_GROUPS_MAX) {
        o->group[group] = (struct occlusion_group){offset_um, velocity_umps, now_us};
    }
}

// ---------------------------------------------------------------- what is in sight

/// velocity * us / 10^6; after 1000 s without news nothing goes on.
static int64_t travel(int64_t velocity, uint64_t elapsed_us) {
    const uint64_t us = elapsed_us < 1000000000U ? elapsed_us : 1000000000U;
    return velocity / 1000 * (int64_t)us / 1000 + velocity % 1000 * (int64_t)us / 1000000;
}

static struct vec3_i64 position_at(const struct occlusion_target *t, uint64_t at_us) {
    const uint64_t us = at_us > t->seen_us ? at_us - t->seen_us : 0U;
    const struct vec3_i64 p = t->last.position_um, v = t->velocity_umps;
    return (struct vec3_i64){p.x + travel(v.x, us), p.y + travel(v.y, us), p.z + travel(v.z, us)};
}

/// The eye that sees a group as it is without its offset: moved back. False: too far away.
static bool eye_of(const struct occlusion *o, uint32_t group, uint64_t at_us, struct vec3 *out) {
    const struct occlusion_group *const g = &o->group[group % OCCLUSION_GROUPS_MAX];
    const uint64_t us = at_us > g->since_us ? at_us - g->since_us : 0U;
    const struct vec3_i64 from = o->config->viewpoint_um, by = g->offset_um, v = g->velocity_umps;
    const int64_t unit = o->config->unit_um;
    const int64_t eye[3] = {(from.x - by.x - travel(v.x, us)) / unit,
                            (from.y - by.y - travel(v.y, us)) / unit,
                            (from.z - by.z - travel(v.z, us)) / unit};
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

static bool all_moves_are_zero(const struct occlusion *o) {
    for (uint32_t g = 0; g < OCCLUSION_GROUPS_MAX; g++) {
        const struct vec3_i64 v = o->group[g].velocity_umps;
        if ((v.x | v.y | v.z) != 0) {
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

/// Relative to the viewpoint, in units; what is farther than every shape comes nearer.
static struct vec3 relative(const struct occlusion *o, struct vec3_i64 position_um) {
    const struct vec3_i64 d = vec3_i64_sub(position_um, o->config->viewpoint_um);
    const int64_t unit = o->config->unit_um;
    const struct vec3_i64 p = {d.x / unit, d.y / unit, d.z / unit};
    if (p.x >= REACH || p.x <= -REACH || p.y >= REACH || p.y <= -REACH || p.z >= REACH ||
        p.z <= -REACH) {
        return vec3_i64_normalise(d);
    }
    return vec3((int32_t)p.x, (int32_t)p.y, (int32_t)p.z);
}

/// The samples of a target at a time: its middle, and eight points of its rim across the line of
/// sight. Returns how many.
static uint32_t samples_of(const struct occlusion *o, const struct occlusion_target *t,
                           uint64_t at_us, struct vec3_i64 out_um[OCCLUSION_SAMPLES]) {
    static const int8_t turn[8][2] = {{2, 0},  {1, 1},   {0, 2},  {-1, 1},
                                      {-2, 0}, {-1, -1}, {0, -2}, {1, -1}};
    const struct vec3_i64 middle = position_at(t, at_us);
    out_um[0] = middle;
    if (t->last.radius_um == 0U) {
        return 1;
    }
    const struct vec3 ahead = vec3_i64_normalise(vec3_i64_sub(middle, o->config->viewpoint_um));
    const bool upright = ahead.x == 0 && ahead.y == 0;
    const struct vec3 side =
        vec3_i64_normalise(vec3_cross(ahead, upright ? vec3(1, 0, 0) : vec3(0, 0, 1)));
    const struct vec3 up = vec3_i64_normalise(vec3_cross(side, ahead));
    for (uint32_t k = 0; k < 8U; k++) {
        const int64_t length[3] = {0, Q30_HALF_ROOT, INT64_C(1) << 30};
        const int64_t u = turn[k][0] < 0 ? -length[-turn[k][0]] : length[turn[k][0]],
                      v = turn[k][1] < 0 ? -length[-turn[k][1]] : length[turn[k][1]];
        const int64_t r = t->last.radius_um;
        // Each product below 2^31: (2^30 * 2^30 >> 30) + the same; times the radius below 2^63.
        out_um[1U + k] = (struct vec3_i64){
            middle.x + ((u * side.x >> 30) + (v * up.x >> 30)) * r / (INT64_C(1) << 30),
            middle.y + ((u * side.y >> 30) + (v * up.y >> 30)) * r / (INT64_C(1) << 30),
            middle.z + ((u * side.z >> 30) + (v * up.z >> 30)) * r / (INT64_C(1) << 30)};
    }
    return OCCLUSION_SAMPLES;
}

/// Which samples of a target are in sight, as bits; a point has all of them or none.
static uint16_t seen_samples(const struct occlusion *o, const struct occlusion_target *t,
                             uint64_t at_us) {
    const uint16_t all = (1U << OCCLUSION_SAMPLES) - 1U;
    if (t->last.kind == TARGET_DIRECTION) {
        return in_sight(o, vec3_normalise(t->last.direction)) ? all : 0U;
    }
    struct vec3_i64 sample_um[OCCLUSION_SAMPLES];
    const uint32_t count = samples_of(o, t, at_us, sample_um);
    uint16_t seen = 0;
    for (uint32_t i = 0; i < count; i++) {
        seen |= in_sight(o, relative(o, sample_um[i])) ? (uint16_t)(1U << i) : 0U;
    }
    return count == 1U ? (seen != 0U ? all : 0U) : seen;
}

bool occlusion_sees(struct occlusion *o, struct vec3_i64 position_um, uint64_t at_us) {
    cast_shadows(o, at_us);
    return in_sight(o, relative(o, position_um));
}

// ---------------------------------------------------------------- a frame

static uint8_t count_bits(uint16_t bits) {
    uint8_t count = 0;
    for (; bits != 0U; bits &= (uint16_t)(bits - 1U)) {
        count++;
    }
    return count;
}

/// Looks ahead, frame by frame. Sets when each target hides or shows, and whether it counts.
static void look_ahead(struct occlusion *o, uint64_t now_us) {
    const struct occlusion_config *const c = o->config;
    const bool still = all_moves_are_zero(o);
    bool any = false;
    uint16_t counted[OCCLUSION_TARGETS_MAX] = {0};
    for (uint64_t ahead = 0; ahead <= c->ahead_us; ahead += c->frame_us) {
        const uint64_t at_us = now_us + ahead;
        if (ahead == 0U || !still) {
            cast_shadows(o, at_us);
        }
        for (uint32_t i = 0; i < o->target_count; i++) {
            struct occlusion_target *const t = &o->target[i];
            const uint16_t seen = seen_samples(o, t, at_us);
            if (ahead == 0U) {
                t->samples = seen;
                t->samples_seen = count_bits(seen);
                t->hides_us = t->shows_us = OCCLUSION_NEVER;
            } else if (t->samples != 0U && seen == 0U && t->hides_us == OCCLUSION_NEVER) {
                t->hides_us = at_us;
            } else if (t->samples == 0U && seen != 0U && t->shows_us == OCCLUSION_NEVER) {
                t->shows_us = at_us;
            }
            const bool matters = c->policy == OCCLUSION_DROP
                                     ? ahead == 0U
                                     : ahead >= c->fade_us || ahead + c->frame_us > c->ahead_us;
            counted[i] |= matters ? seen : 0U;
            any = any || counted[i] != 0U;
        }
    }
    for (uint32_t i = 0; i < o->target_count && any; i++) {
        o->target[i].counts = counted[i] != 0U;
        o->target[i].samples_counted = counted[i];
    }
}

/// 3 l^2 - 2 l^3: begins and ends without a jerk.
static uint32_t smooth_q16(uint32_t level_q16) {
    const uint64_t l = level_q16;
    return (uint32_t)(l * l * (3U * 65536U - 2U * l) >> 32);
}

static void move_levels(struct occlusion *o, uint64_t elapsed_us) {
    const struct occlusion_config *const c = o->config;
    const uint64_t step =
        c->policy == OCCLUSION_DROP || c->fade_us == 0U || elapsed_us >= c->fade_us
            ? 65536U
            : elapsed_us * 65536U / c->fade_us;
    for (uint32_t i = 0; i < o->target_count; i++) {
        struct occlusion_target *const t = &o->target[i];
        const uint64_t level = t->level_q16;
        const uint64_t more = level + step < 65536U ? level + step : 65536U;
        const uint64_t less = level > step ? level - step : 0U;
        const bool fresh = t->reports == 1U && level == 0U && t->counts;
        t->level_q16 = fresh ? 65536U : (uint32_t)(t->counts ? more : less);
    }
}

/// The mean of the positions, each as much as it counts.
static void find_middle(struct occlusion *o, uint64_t now_us) {
    struct vec3_i64 sum = {0, 0, 0};
    int64_t weight = 0;
    for (uint32_t i = 0; i < o->target_count; i++) {
        const struct occlusion_target *const t = &o->target[i];
        if (t->last.kind == TARGET_POSITION && t->last.weight_q16 != 0U) {
            const struct vec3_i64 p = position_at(t, now_us), v = o->config->viewpoint_um;
            const int64_t w = smooth_q16(t->level_q16) >> 8; // 0 to 256
            sum.x += (p.x - v.x) / 256 * w;
            sum.y += (p.y - v.y) / 256 * w;
            sum.z += (p.z - v.z) / 256 * w;
            weight += w;
        }
    }
    o->middle_known = weight != 0;
    if (o->middle_known) {
        const struct vec3_i64 v = o->config->viewpoint_um;
        o->middle_um = (struct vec3_i64){v.x + sum.x / weight * 256, v.y + sum.y / weight * 256,
                                         v.z + sum.z / weight * 256};
    }
}

bool occlusion_step(struct occlusion *o, uint64_t now_us) {
    if (o->started && now_us < o->next_frame_us) {
        return false;
    }
    const uint64_t elapsed_us = o->started ? now_us - o->frame_us : 0U;
    o->started = true;
    o->frame_us = now_us;
    o->next_frame_us = now_us + o->config->frame_us;
    look_ahead(o, now_us);
    move_levels(o, elapsed_us);
    find_middle(o, now_us);
    o->next_out = 0;
    return o->target_count != 0U;
}

// ---------------------------------------------------------------- what comes out

static int64_t blend(int64_t from, int64_t to, uint32_t part_q16) {
    return from + (to - from) / 65536 * part_q16 + (to - from) % 65536 * part_q16 / 65536;
}

/// The ball around the samples in sight: their mean, and the farthest of them.
static void keep_visible(const struct occlusion *o, const struct occlusion_target *t,
                         struct target_update *out) {
    struct vec3_i64 sample_um[OCCLUSION_SAMPLES], mean = {0, 0, 0};
    struct occlusion_target at = *t;
    at.last.position_um = out->position_um;
    at.velocity_umps = (struct vec3_i64){0, 0, 0};
    const uint8_t count = count_bits(t->samples_counted);
    if (samples_of(o, &at, t->seen_us, sample_um) == 1U || count == 0U ||
        count == OCCLUSION_SAMPLES) {
        return;
    }
    uint64_t radius_um = 0;
    for (uint32_t i = 0; i < OCCLUSION_SAMPLES; i++) {
        if ((t->samples_counted >> i & 1U) != 0U) {
            const struct vec3_i64 d = vec3_i64_sub(sample_um[i], out->position_um);
            mean = (struct vec3_i64){mean.x + d.x, mean.y + d.y, mean.z + d.z};
        }
    }
    mean =
        (struct vec3_i64){out->position_um.x + mean.x / count, out->position_um.y + mean.y / count,
                          out->position_um.z + mean.z / count};
    for (uint32_t i = 0; i < OCCLUSION_SAMPLES; i++) {
        const uint64_t away = vec3_i64_length(vec3_i64_sub(sample_um[i], mean)) + 1U;
        radius_um = (t->samples_counted >> i & 1U) != 0U && away > radius_um ? away : radius_um;
    }
    out->position_um = mean;
    out->radius_um = (uint32_t)radius_um;
}

static void adjust(const struct occlusion *o, const struct occlusion_target *t,
                   struct target_update *out) {
    const uint32_t part_q16 = smooth_q16(t->level_q16);
    if (out->kind != TARGET_POSITION) {
        out->weight_q16 = part_q16 >= 32768U ? out->weight_q16 : 0U;
        return;
    }
    if (t->counts) {
        keep_visible(o, t, out);
    }
    if (part_q16 == 0U || !o->middle_known) {
        out->weight_q16 = part_q16 == 0U && o->middle_known ? 0U : out->weight_q16;
        return;
    }
    out->position_um = (struct vec3_i64){blend(o->middle_um.x, out->position_um.x, part_q16),
                                         blend(o->middle_um.y, out->position_um.y, part_q16),
                                         blend(o->middle_um.z, out->position_um.z, part_q16)};
    out->radius_um = (uint32_t)((uint64_t)out->radius_um * part_q16 >> 16);
}

bool occlusion_next(struct occlusion *o, struct target_update *out) {
    if (o->next_out >= o->target_count) {
        return false;
    }
    const struct occlusion_target *const t = &o->target[o->next_out++];
    *out = t->last;
    if (out->kind == TARGET_POSITION) {
        out->position_um = position_at(t, o->frame_us);
    }
    adjust(o, t, out);
    return true;
}

bool occlusion_adjust(const struct occlusion *o, const struct target_update *in,
                      struct target_update *out) {
    const uint32_t index = find(o, in->id);
    *out = *in;
    if (index == o->target_count || !o->started) {
        return false;
    }
    adjust(o, &o->target[index], out);
    return true;
}

#include "target/occlusion_private.h"

#define ONE_Q16       65536U
#define AHEAD_US_MAX  10000000U
#define TRAVEL_US_MAX (UINT64_C(1) << 24)
#define VELOCITY_MAX  (INT64_C(1) << 38) ///< 275 km/s: what is faster is at another place
#define CLEAR_US      20000U ///< what is cleared is reported again within this time, or leaves
#define UNIT_LEVELS   4U     ///< targets
#define UNIT_OUT      2U

// ---------------------------------------------------------------- start

size_t occlusion_workspace_bytes(const struct shape_set *shapes) {
    return SIGHT_BOUNDS_MAX(shapes->face_count, shapes->edge_count, shapes->corner_count) *
               sizeof(struct sight_bound) +
           ((size_t)shapes->object_count + shapes->face_count) * sizeof(struct sight_piece);
}

bool occlusion_settings_valid(const struct occlusion_settings *s) {
    return s->frame_us >= 1000U && s->frame_us <= 1000000U && s->fade_us <= s->ahead_us &&
           s->ahead_us <= AHEAD_US_MAX && s->ahead_us / s->frame_us <= OCCLUSION_FRAMES_MAX &&
           s->hidden_q16 <= ONE_Q16;
}

static bool is_near(const struct occlusion_config *config, int64_t um) {
    const int64_t at = units_from_um(config->units, um);
    return at <= SHAPE_COORDINATE_MAX && at >= -SHAPE_COORDINATE_MAX;
}

static bool start(struct occlusion *o, const struct occlusion_config *config) {
    *o = (struct occlusion){.config = config};
    return occlusion_settings_valid(&config->settings) && is_near(config, config->viewpoint_um.x) &&
           is_near(config, config->viewpoint_um.y) && is_near(config, config->viewpoint_um.z);
}

bool occlusion_init(struct occlusion *o, const struct occlusion_config *config, void *workspace,
                    size_t workspace_bytes) {
    const struct shape_set *const shapes = config->shapes;
    const size_t bounds =
        SIGHT_BOUNDS_MAX(shapes->face_count, shapes->edge_count, shapes->corner_count);
    if (!start(o, config) || workspace_bytes < occlusion_workspace_bytes(shapes)) {
        return false;
    }
    o->sight.bounds = workspace;
    o->sight.bound_room = (uint32_t)bounds;
    o->sight.pieces = (struct sight_piece *)(void *)(o->sight.bounds + bounds);
    o->sight.piece_room = shapes->object_count + shapes->face_count;
    return true;
}

bool occlusion_init_shadows(struct occlusion *o, const struct occlusion_config *config,
                            const struct sight *shadows) {
    const bool valid = start(o, config) && config->shapes == NULL;
    o->sight = *shadows;
    return valid;
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

static void take_out(struct occlusion *o, uint32_t index) {
    const uint32_t last = --o->target_count;
    if (index != last) {
        o->target[index] = o->target[last];
    }
    occlusion_look_without(o, index);
    occlusion_look_without(o, last);
}

/// Micrometres in 2^20 us.
static int64_t rate(int64_t from, int64_t to, uint64_t elapsed_us) {
    const int64_t most = INT64_C(1) << 42, way = to - from;
    if (way >= most || way <= -most) {
        return 0;
    }
    const int64_t velocity = way * (INT64_C(1) << 20) / (int64_t)elapsed_us;
    return velocity < VELOCITY_MAX && velocity > -VELOCITY_MAX ? velocity : 0;
}

/// The mean of the last few velocities; the first one as it is.
static void take_velocity(struct occlusion_target *t, const struct target_update *update,
                          uint64_t now_us) {
    const uint64_t elapsed_us = now_us - t->since_us;
    if (t->last.kind != TARGET_POSITION || update->kind != TARGET_POSITION || elapsed_us == 0U) {
        return;
    }
    const struct vec3_i64 a = t->last.position_um, b = update->position_um;
    const struct vec3_i64 fresh = {rate(a.x, b.x, elapsed_us), rate(a.y, b.y, elapsed_us),
                                   rate(a.z, b.z, elapsed_us)};
    struct vec3_i64 *const v = &t->velocity_ump20;
    const bool first = t->reports == 1U;
    v->x = first ? fresh.x : v->x + (fresh.x - v->x) / 8;
    v->y = first ? fresh.y : v->y + (fresh.y - v->y) / 8;
    v->z = first ? fresh.z : v->z + (fresh.z - v->z) / 8;
}

/// False: there were more than OCCLUSION_TARGETS_MAX: the controller has to clear, too.
static bool clear(struct occlusion *o, uint64_t now_us) {
    if (o->passed) {
        occlusion_forget(o);
        return false;
    }
    for (uint32_t i = 0; i < o->target_count; i++) {
        o->target[i].cleared = true;
        o->target[i].cleared_us = now_us;
    }
    return true;
}

bool occlusion_report(struct occlusion *o, const struct target_update *update, uint64_t now_us) {
    if (update->kind == TARGET_CLEAR) {
        return o->config->settings.policy != OCCLUSION_IGNORE && clear(o, now_us);
    }
    const uint32_t index = find(o, update->id);
    const bool known = index < o->target_count;
    if (update->kind == TARGET_GONE) {
        if (known) {
            take_out(o, index);
        }
        return false;
    }
    if (o->config->settings.policy == OCCLUSION_IGNORE ||
        (!known && o->target_count == OCCLUSION_TARGETS_MAX)) {
        o->passed = true;
        return false;
    }
    struct occlusion_target *const t = &o->target[index];
    if (known) {
        take_velocity(t, update, now_us);
    } else {
        o->target_count++;
        *t = (struct occlusion_target){.is_new = true,
                                       .counts = true,
                                       .hides_us = OCCLUSION_NEVER,
                                       .shows_us = OCCLUSION_NEVER};
    }
    t->last = *update;
    t->heard_us = t->since_us = now_us;
    t->reports++;
    t->cleared = t->leaves = false;
    return true;
}

void occlusion_forget(struct occlusion *o) {
    o->target_count = 0;
    o->passed = false;
    o->look.runs = false;
    o->frame_stage = OCCLUSION_FRAME_DONE;
}

void occlusion_move(struct occlusion *o, uint32_t group, struct vec3_i64 offset_um,
                    struct vec3_i64 velocity_umps, uint64_t now_us) {
    if (group < OCCLUSION_GROUPS_MAX) {
        struct occlusion_group *const g = &o->group[group];
        const struct vec3_i64 v = {rate(0, velocity_umps.x, 1000000U),
                                   rate(0, velocity_umps.y, 1000000U),
                                   rate(0, velocity_umps.z, 1000000U)};
        const struct vec3_i64 by = vec3_i64_sub(g->offset_um, offset_um);
        o->cast = o->cast && (v.x | v.y | v.z | by.x | by.y | by.z) == 0;
        *g = (struct occlusion_group){offset_um, v, now_us};
    }
}

void occlusion_by_object(struct occlusion *o, bool by_object) {
    o->by_object = by_object;
}

// ---------------------------------------------------------------- where they are

struct vec3_i64 occlusion_travel(struct vec3_i64 v, uint64_t elapsed_us) {
    const int64_t us = (int64_t)(elapsed_us < TRAVEL_US_MAX ? elapsed_us : TRAVEL_US_MAX);
    return (struct vec3_i64){v.x * us >> 20, v.y * us >> 20, v.z * us >> 20};
}

struct vec3_i64 occlusion_position_at(const struct occlusion_target *t, uint64_t at_us) {
    const struct vec3_i64 p = t->last.position_um;
    const struct vec3_i64 way =
        occlusion_travel(t->velocity_ump20, at_us > t->since_us ? at_us - t->since_us : 0U);
    return (struct vec3_i64){p.x + way.x, p.y + way.y, p.z + way.z};
}

/// Of one that is silent for as long as we look ahead nobody knows how it goes on.
static void stop_silent(const struct occlusion *o, struct occlusion_target *t) {
    const uint64_t ahead_us = o->config->settings.ahead_us;
    if (t->last.kind == TARGET_POSITION && o->frame_us > t->since_us + ahead_us) {
        t->last.position_um = occlusion_position_at(t, t->since_us + ahead_us);
        t->since_us = o->frame_us;
        t->velocity_ump20 = (struct vec3_i64){0, 0, 0};
    }
}

// ---------------------------------------------------------------- a frame

/// 3 l^2 - 2 l^3: begins and ends without a jerk.
static uint32_t smooth_q16(uint32_t level_q16) {
    const uint64_t l = level_q16;
    return (uint32_t)(l * l * (3U * ONE_Q16 - 2U * l) >> 32);
}

/// How far on the way from the middle it is.
static uint32_t part_q16(const struct occlusion *o, const struct occlusion_target *t) {
    const struct occlusion_settings *const s = &o->config->settings;
    const uint64_t least = s->policy == OCCLUSION_WEIGH ? s->hidden_q16 : 0U;
    return (uint32_t)(least + ((ONE_Q16 - least) * smooth_q16(t->level_q16) >> 16));
}

static uint32_t level_step(const struct occlusion *o) {
    const struct occlusion_settings *const s = &o->config->settings;
    return s->policy == OCCLUSION_DROP || s->fade_us == 0U || o->elapsed_us >= s->fade_us
               ? ONE_Q16
               : (uint32_t)o->elapsed_us * ONE_Q16 / s->fade_us;
}

static void move_level(struct occlusion_target *t, uint32_t step) {
    const uint32_t level = t->level_q16;
    const uint32_t more = level + step < ONE_Q16 ? level + step : ONE_Q16;
    const uint32_t less = level > step ? level - step : 0U;
    t->level_q16 = t->is_new && t->counts ? ONE_Q16 : (t->counts ? more : less);
    t->is_new = false;
}

/// The middle of an object's own; OCCLUSION_MIDDLES_MAX and more: there is none.
static uint32_t find_own(const struct occlusion *o, uint16_t object) {
    uint32_t i = 0;
    while (i < o->middle_count && o->middle[i].object != object) {
        i++;
    }
    return i < o->middle_count ? i : OCCLUSION_MIDDLES_MAX;
}

static struct occlusion_middle *make_own(struct occlusion *o, uint16_t object) {
    const uint32_t own = find_own(o, object);
    if (own < OCCLUSION_MIDDLES_MAX) {
        return &o->middle[own];
    }
    if (o->middle_count == OCCLUSION_MIDDLES_MAX) {
        return NULL;
    }
    o->middle[o->middle_count] = (struct occlusion_middle){.object = object};
    return &o->middle[o->middle_count++];
}

static const struct occlusion_middle *middle_for(const struct occlusion *o, uint16_t object) {
    const uint32_t own = o->by_object ? find_own(o, object) : OCCLUSION_MIDDLES_MAX;
    return own < OCCLUSION_MIDDLES_MAX ? &o->middle[own] : &o->middle_of_all;
}

static void add_to_middle(struct occlusion *o, struct occlusion_middle *m,
                          const struct occlusion_target *t) {
    const int64_t w = smooth_q16(t->level_q16) >> 8; // 0 to 256
    if (t->last.kind == TARGET_POSITION) {
        const struct vec3_i64 d =
            vec3_i64_sub(occlusion_position_at(t, o->frame_us), o->config->viewpoint_um);
        m->sum_um.x += d.x / 256 * w;
        m->sum_um.y += d.y / 256 * w;
        m->sum_um.z += d.z / 256 * w;
        m->weight += w;
    } else {
        const struct vec3 d = vec3_normalise(t->last.direction);
        m->sum_q30.x += d.x * w;
        m->sum_q30.y += d.y * w;
        m->sum_q30.z += d.z * w;
        m->weight_toward += w;
    }
}

static void find_middle(const struct occlusion *o, struct occlusion_middle *m) {
    const struct vec3_i64 v = o->config->viewpoint_um, sum = m->sum_um;
    if (m->weight != 0) {
        m->middle_um =
            (struct vec3_i64){v.x + sum.x / m->weight * 256, v.y + sum.y / m->weight * 256,
                              v.z + sum.z / m->weight * 256};
        if (m->weight_toward == 0) {
            m->sum_q30 = vec3_i64_sub(m->middle_um, v);
        }
    }
    const struct vec3_i64 toward = m->sum_q30;
    m->weight_toward = (toward.x | toward.y | toward.z) != 0 ? 1 : 0;
    if (m->weight_toward != 0) {
        m->toward_q30 = vec3_i64_normalise(toward);
    }
}

/// A report may have come since the frame began: its time is then behind the frame's.
static bool has_expired(const struct occlusion *o, const struct occlusion_target *t) {
    const uint64_t expiry_us = o->config->expiry_us;
    return (expiry_us != 0U && o->frame_us > t->heard_us + expiry_us) ||
           (t->cleared && o->frame_us >= t->cleared_us + CLEAR_US);
}

static void begin_frame(struct occlusion *o, uint64_t now_us) {
    o->elapsed_us = o->started ? now_us - o->frame_us : 0U;
    o->started = true;
    o->frame_us = now_us;
    o->next_frame_us = now_us + o->config->settings.frame_us;
    o->frame_stage = OCCLUSION_FRAME_LEVELS;
    o->frame_next = 0;
    o->middle_count = 0;
    o->middle_of_all = (struct occlusion_middle){.weight = 0};
}

static void work_levels(struct occlusion *o) {
    const uint32_t step = level_step(o);
    for (uint32_t i = 0; i < UNIT_LEVELS && o->frame_next < o->target_count; i++) {
        struct occlusion_target *const t = &o->target[o->frame_next++];
        t->is_out = false;
        t->leaves = has_expired(o, t);
        stop_silent(o, t);
        move_level(t, step);
        if (t->last.weight_q16 == 0U || t->leaves) {
            continue;
        }
        add_to_middle(o, &o->middle_of_all, t);
        struct occlusion_middle *const own = o->by_object ? make_own(o, t->last.object) : NULL;
        if (own != NULL) {
            add_to_middle(o, own, t);
        }
    }
    if (o->frame_next >= o->target_count) {
        o->frame_stage = OCCLUSION_FRAME_MIDDLES;
        o->frame_next = 0;
    }
}

static void work_middles(struct occlusion *o) {
    find_middle(o, o->frame_next == 0U ? &o->middle_of_all : &o->middle[o->frame_next - 1U]);
    if (++o->frame_next > o->middle_count) {
        o->frame_stage = OCCLUSION_FRAME_OUT;
        o->frame_next = 0;
    }
}

// ---------------------------------------------------------------- what comes out

static int64_t blend(int64_t from, int64_t to, uint32_t part) {
    return from + (to - from) / 65536 * part + (to - from) % 65536 * part / 65536;
}

/// A direction turns from the middle's; without one it counts while it counts by half.
static void adjust_direction(const struct occlusion_middle *m, uint32_t part,
                             struct target_update *out) {
    if (part == ONE_Q16) {
        return;
    }
    if (m->weight_toward == 0) {
        out->weight_q16 = part >= ONE_Q16 / 2U ? out->weight_q16 : 0U;
        return;
    }
    const struct vec3 to = vec3_normalise(out->direction), from = m->toward_q30;
    const int64_t w = part, rest = ONE_Q16 - part;
    const struct vec3_i64 sum = {from.x * rest + to.x * w, from.y * rest + to.y * w,
                                 from.z * rest + to.z * w};
    out->weight_q16 = part == 0U ? 0U : out->weight_q16;
    if ((sum.x | sum.y | sum.z) != 0) { // not opposite
        out->direction = vec3_i64_normalise(sum);
    }
    out->radius_bam32 = (uint32_t)((uint64_t)out->radius_bam32 * part >> 16);
}

static void adjust(const struct occlusion *o, const struct occlusion_target *t,
                   struct target_update *out) {
    const uint32_t part = part_q16(o, t);
    const struct occlusion_middle *const m = middle_for(o, t->last.object);
    if (out->kind != TARGET_POSITION) {
        adjust_direction(m, part, out);
        return;
    }
    if (t->counts && t->is_part) {
        out->position_um =
            (struct vec3_i64){out->position_um.x + t->part_um.x, out->position_um.y + t->part_um.y,
                              out->position_um.z + t->part_um.z};
        out->radius_um = t->part_radius_um;
    }
    if (part == 0U || m->weight == 0) {
        out->weight_q16 = part == 0U && (m->weight | m->weight_toward) != 0 ? 0U : out->weight_q16;
        return;
    }
    out->position_um = (struct vec3_i64){blend(m->middle_um.x, out->position_um.x, part),
                                         blend(m->middle_um.y, out->position_um.y, part),
                                         blend(m->middle_um.z, out->position_um.z, part)};
    out->radius_um = (uint32_t)((uint64_t)out->radius_um * part >> 16);
}

static void work_out(struct occlusion *o) {
    for (uint32_t i = 0; i < UNIT_OUT && o->frame_next < o->target_count; i++) {
        struct occlusion_target *const t = &o->target[o->frame_next++];
        t->is_out = true;
        t->out = t->last;
        if (t->leaves) {
            t->out.kind = TARGET_GONE;
            continue;
        }
        if (t->out.kind == TARGET_POSITION) {
            t->out.position_um = occlusion_position_at(t, o->frame_us);
        }
        adjust(o, t, &t->out);
    }
    if (o->frame_next >= o->target_count) {
        o->frame_stage = OCCLUSION_FRAME_DONE;
        o->next_out = 0;
    }
}

static bool work_frame(struct occlusion *o) {
    switch (o->frame_stage) {
    case OCCLUSION_FRAME_LEVELS:
        work_levels(o);
        return true;
    case OCCLUSION_FRAME_MIDDLES:
        work_middles(o);
        return true;
    case OCCLUSION_FRAME_OUT:
        work_out(o);
        return true;
    default:
        return false;
    }
}

void occlusion_step(struct occlusion *o, uint64_t now_us, bool all) {
    if ((o->started && now_us < o->next_frame_us) || o->frame_stage != OCCLUSION_FRAME_DONE) {
        return;
    }
    if (all) {
        occlusion_look_begin(o, now_us);
        while (occlusion_look_work(o, now_us)) {
        }
    }
    begin_frame(o, now_us);
    while (all && work_frame(o)) {
    }
}

bool occlusion_work(struct occlusion *o, uint64_t now_us) {
    if (work_frame(o)) {
        return true;
    }
    if (o->look.runs) {
        (void)occlusion_look_work(o, now_us);
        return true;
    }
    const bool begins =
        o->target_count != 0U &&
        (o->look.number == 0U || now_us - o->look.at_us >= o->config->settings.frame_us);
    if (begins) {
        occlusion_look_begin(o, now_us);
    }
    return begins;
}

bool occlusion_next(struct occlusion *o, struct target_update *out) {
    if (o->frame_stage != OCCLUSION_FRAME_DONE) {
        return false;
    }
    while (o->next_out < o->target_count) {
        struct occlusion_target *const t = &o->target[o->next_out];
        const bool ready = t->is_out;
        *out = t->out;
        t->is_out = false;
        if (ready && t->leaves) {
            take_out(o, o->next_out);
            return true;
        }
        o->next_out++;
        if (ready) {
            return true;
        }
    }
    return false;
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

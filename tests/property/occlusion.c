/// What is in sight, and when that changes: firmware/target/occlusion.h against rays in rational
/// numbers, frame by frame into the future. SEED=N, COUNT=N scenes.
#include "check.h"
#include "property/support/hidden_scenes.h"
#include "property/support/solid_check.h"

#include "target/occlusion.h"

#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long scene_count = 80UL;

#define GROUPS   4U
#define TARGETS  12U
#define FRAME_US 40000U
#define AHEAD_US 1200000U

struct world {
    struct hidden_scene scene;
    uint8_t group[HIDDEN_BODIES_MAX];
    struct vec3_i64 offset_um[GROUPS], velocity_umps[GROUPS];
    struct vec3_i64 start_um[TARGETS], target_umps[TARGETS];
    uint32_t radius_um[TARGETS];
    struct vec3_i64 viewpoint_um;
};

static int64_t within(int64_t reach) {
    return (int64_t)(check_random(&seed) % (uint64_t)(2 * reach + 1)) - reach;
}

static struct vec3_i64 draw(int64_t reach) {
    struct vec3_i64 v;
    v.x = within(reach);
    v.y = within(reach);
    v.z = within(reach);
    return v;
}

/// Boxes of some metres in millimetres, around a viewpoint, in four groups of which half move, or
/// none: standing shadows are looked at in another way.
static void draw_world(struct world *w, bool moves) {
    hidden_scene_open(&w->scene, HIDDEN_BODIES_MAX);
    for (uint32_t i = 0; i < 16U; i++) {
        const struct vec3 corner =
            vec3((int32_t)within(20000), (int32_t)within(20000), (int32_t)within(20000));
        (void)hidden_scene_box(&w->scene, corner,
                               vec3(1000 + (int32_t)solid_below(&seed, 6000), 0, 0),
                               vec3(0, 1000 + (int32_t)solid_below(&seed, 6000), 0),
                               vec3(0, 0, 1000 + (int32_t)solid_below(&seed, 6000)));
        w->group[i] = (uint8_t)(i % GROUPS);
    }
    for (uint32_t g = 0; g < GROUPS; g++) {
        w->offset_um[g] = draw(5000000);
        w->velocity_umps[g] = g % 2U == 0U || !moves ? (struct vec3_i64){0, 0, 0} : draw(8000000);
    }
    for (uint32_t i = 0; i < TARGETS; i++) {
        w->start_um[i] = draw(40000000);
        w->target_umps[i] = draw(10000000);
        w->radius_um[i] = i % 3U == 0U ? 1500000U : 0U;
    }
    w->viewpoint_um = draw(2000000);
}

static int64_t moved(int64_t start, int64_t velocity, uint64_t us) {
    return start + velocity * (int64_t)us / 1000000;
}

static struct vec3_i64 moved3(struct vec3_i64 start, struct vec3_i64 v, uint64_t us) {
    return (struct vec3_i64){moved(start.x, v.x, us), moved(start.y, v.y, us),
                             moved(start.z, v.z, us)};
}

/// Everything in millimetres, as the shapes are; the bodies stay, viewpoint and target move.
static bool ray_sees(const struct world *w, struct vec3_i64 target_um, uint64_t at_us) {
    bool sees = true;
    struct ray_point point;
    ray_point_init(&point);
    for (uint32_t i = 0; i < w->scene.body_count && sees; i++) {
        const uint32_t g = w->group[i];
        const struct vec3_i64 o = moved3(w->offset_um[g], w->velocity_umps[g], at_us);
        const int64_t eye[3] = {w->viewpoint_um.x - o.x, w->viewpoint_um.y - o.y,
                                w->viewpoint_um.z - o.z},
                      to[3] = {target_um.x - o.x, target_um.y - o.y, target_um.z - o.z};
        int32_t eye_mm[3];
        for (int k = 0; k < 3; k++) {
            eye_mm[k] = (int32_t)(eye[k] / 1000);
            mpz_set_si(point.x[k], to[k]);
        }
        mpz_set_ui(point.w, 1000);
        sees = !ray_is_stopped(&w->scene.body[i], eye_mm, &point);
    }
    ray_point_clear(&point);
    return sees;
}

static uint64_t checked, off_by_rounding, forecasts, changes;

/// In the ray's eyes, is a place in sight, just beside it, too? Places within a few millimetres of
/// a shadow's border may be decided either way: units are millimetres.
static bool near_border(const struct world *w, struct vec3_i64 p, uint64_t at_us, bool sees) {
    for (int k = 0; k < 6; k++) {
        struct vec3_i64 q = p;
        const int64_t step = k % 2 == 0 ? 8000 : -8000;
        q.x += k / 2 == 0 ? step : 0;
        q.y += k / 2 == 1 ? step : 0;
        q.z += k / 2 == 2 ? step : 0;
        if (ray_sees(w, q, at_us) != sees) {
            return true;
        }
    }
    return false;
}

static bool brute_sees(const struct world *w, uint32_t i, uint64_t at_us, bool said) {
    const struct vec3_i64 p = moved3(w->start_um[i], w->target_umps[i], at_us);
    const bool sees = ray_sees(w, p, at_us);
    checked++;
    if (sees != said && near_border(w, p, at_us, sees)) {
        off_by_rounding++;
        return said;
    }
    return sees;
}

/// The first frame after now at which a ray says otherwise.
static uint64_t brute_change(const struct world *w, uint32_t i, uint64_t now_us, bool sees) {
    for (uint64_t at_us = now_us + FRAME_US; at_us <= now_us + AHEAD_US; at_us += FRAME_US) {
        const struct vec3_i64 p = moved3(w->start_um[i], w->target_umps[i], at_us);
        if (ray_sees(w, p, at_us) != sees) {
            return at_us;
        }
    }
    return OCCLUSION_NEVER;
}

static void tell(const struct world *w, struct occlusion *o, uint64_t now_us) {
    for (uint32_t g = 0; g < GROUPS; g++) {
        occlusion_move(o, g, moved3(w->offset_um[g], w->velocity_umps[g], now_us),
                       w->velocity_umps[g], now_us);
    }
    for (uint32_t i = 0; i < TARGETS; i++) {
        const struct target_update update = {.kind = TARGET_POSITION,
                                             .id = i,
                                             .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                             .position_um =
                                                 moved3(w->start_um[i], w->target_umps[i], now_us),
                                             .radius_um = w->radius_um[i]};
        CHECK(occlusion_report(o, &update, now_us));
    }
}

static bool check_target(const struct world *w, const struct occlusion_target *t, uint32_t i,
                         uint64_t now_us) {
    const bool sees = (t->samples & 1U) != 0U; // the middle
    bool right = CHECK_EQ(sees, brute_sees(w, i, now_us, sees));
    if (w->radius_um[i] == 0U && right) {
        const uint64_t said = sees ? t->hides_us : t->shows_us,
                       wanted = brute_change(w, i, now_us, sees);
        forecasts++;
        changes += wanted != OCCLUSION_NEVER;
        const bool close = said == wanted || said + FRAME_US == wanted ||
                           wanted + FRAME_US == said ||
                           // beyond the last frame, or a sliver of a few millimetres
                           (said == OCCLUSION_NEVER && wanted + FRAME_US > now_us + AHEAD_US) ||
                           (wanted == OCCLUSION_NEVER && said + FRAME_US > now_us + AHEAD_US);
        const uint64_t first = said < wanted ? said : wanted;
        right =
            CHECK(close || near_border(w, moved3(w->start_um[i], w->target_umps[i], first), first,
                                       ray_sees(w, moved3(w->start_um[i], w->target_umps[i], first),
                                                first)));
    }
    return right;
}

static void sight_and_forecast(void) {
    for (unsigned long n = 0; n < scene_count && check_clean(); n++) {
        static struct world w;
        static struct occlusion o;
        draw_world(&w, n % 2U == 0U);
        const struct occlusion_config config = {.shapes = &w.scene.set,
                                                .group = w.group,
                                                .units = units_of_um(1000),
                                                .viewpoint_um = w.viewpoint_um,
                                                .settings = {.policy = OCCLUSION_CALM,
                                                             .frame_us = FRAME_US,
                                                             .ahead_us = AHEAD_US,
                                                             .fade_us = 400000}};
        const size_t bytes = occlusion_workspace_bytes(&w.scene.set);
        void *const workspace = malloc(bytes);
        CHECK(occlusion_init(&o, &config, workspace, bytes));
        for (uint64_t now_us = 0; now_us <= 25U * FRAME_US && check_clean(); now_us += FRAME_US) {
            tell(&w, &o, now_us);
            occlusion_step(&o, now_us, true);
            // From the second report on, velocities are known.
            for (uint32_t i = 0; i < TARGETS && now_us == 25U * FRAME_US; i++) {
                if (!check_target(&w, &o.target[i], i, now_us)) {
                    printf("# scene %lu target %u\n", n, i);
                }
            }
        }
        free(workspace);
        hidden_scene_close(&w.scene);
    }
    printf("MEASURED %llu places in sight or not, %llu within 8 mm of a border and decided the "
           "other way; %llu "
           "forecasts of %d ms, %llu of them of a change\n",
           (unsigned long long)checked, (unsigned long long)off_by_rounding,
           (unsigned long long)forecasts, AHEAD_US / 1000, (unsigned long long)changes);
    CHECK(changes > 20U && forecasts > changes && off_by_rounding * 20U < checked);
}

/// A wall between the viewpoint and the left half of a ball: what counts is the right half.
static void visible_part(void) {
    struct hidden_scene scene;
    struct occlusion o;
    struct target_update out;
    hidden_scene_open(&scene, 4);
    CHECK_EQ(hidden_scene_box(&scene, vec3(-9000, 10000, -9000), vec3(8999, 0, 0), vec3(0, 500, 0),
                              vec3(0, 0, 18000)),
             SHAPE_OK);
    const struct occlusion_config config = {
        .shapes = &scene.set,
        .units = units_of_um(1000),
        .settings = {.policy = OCCLUSION_DROP, .frame_us = FRAME_US, .ahead_us = AHEAD_US}};
    const size_t bytes = occlusion_workspace_bytes(&scene.set);
    void *const workspace = malloc(bytes);
    const struct target_update ball = {.kind = TARGET_POSITION,
                                       .id = 5,
                                       .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                       .position_um = {0, 20000000, 0},
                                       .radius_um = 2000000},
                               hidden = {.kind = TARGET_POSITION,
                                         .id = 6,
                                         .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                         .position_um = {-5000000, 20000000, 0}};
    CHECK(occlusion_init(&o, &config, workspace, bytes));
    CHECK(occlusion_report(&o, &ball, 0) && occlusion_report(&o, &hidden, 0));
    occlusion_step(&o, 0, true);
    CHECK(occlusion_next(&o, &out));
    CHECK_EQ(o.target[0].samples_seen, 6); // the middle, top, bottom, and three on the right
    CHECK_NEAR(out.position_um.x, (2000000 + 2 * 1414214) / 6, 3);
    CHECK_NEAR(out.position_um.z, 0, 3);
    CHECK(out.weight_q16 == TARGET_WEIGHT_ONE_Q16 && out.radius_um < 2400000U);
    CHECK(occlusion_next(&o, &out) && out.id == 6U && out.weight_q16 == 0U);
    CHECK(!occlusion_next(&o, &out));
    occlusion_step(&o, 10, true); // not due
    CHECK(!occlusion_next(&o, &out));
    // The wall goes as far as numbers do: it hides nothing any more.
    occlusion_move(&o, 0, (struct vec3_i64){INT64_C(1) << 60, 0, 0}, (struct vec3_i64){0, 0, 0}, 0);
    occlusion_step(&o, FRAME_US, true);
    CHECK(o.target[0].samples_seen == OCCLUSION_SAMPLES && o.target[1].samples != 0U);
    free(workspace);
    hidden_scene_close(&scene);
}

int main(void) {
    const char *const count_text = getenv("COUNT"), *const seed_text = getenv("SEED");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) : 61U;
    if (count_text != NULL) {
        scene_count = strtoul(count_text, NULL, 10);
    }
    printf("# seed %llu\n", (unsigned long long)seed);
    TEST(sight_and_forecast);
    TEST(visible_part);
    return check_finish();
}

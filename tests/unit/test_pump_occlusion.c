/// The pump with something that hides targets before it: what the controller hears, and when.
#include "unit/desk.h"

#include "app/pump_occlusion.h"

#define METRE INT64_C(1000000)

static struct sight_bound bounds[16];
static struct sight_piece pieces[2];
static struct occlusion_config config;
static struct occlusion occlusion;
static struct pump_occlusion stage;

/// After each tick, as a board does it.
static void ticks(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        desk_ticks(1);
        pump_occlusion_step(&stage, &desk_loop.pump);
        for (int k = 0; k < 8 && !stage.all; k++) {
            (void)occlusion_work(&occlusion, stage.time_us);
        }
    }
}

/// Everything east of the viewpoint and beyond 10 m north is hidden.
static void begin(enum occlusion_policy policy, bool all) {
    bounds[0] = (struct sight_bound){.normal = {0, -1, 0}, .offset = i128_from_i64(-10000)};
    bounds[1] = (struct sight_bound){.normal = {-1, 0, 0}, .offset = i128_from_i64(0)};
    pieces[0] = (struct sight_piece){0, 2};
    const struct sight sight = {.bounds = bounds,
                                .pieces = pieces,
                                .bound_count = 2,
                                .piece_count = 1,
                                .bound_room = 16,
                                .piece_room = 2};
    config = (struct occlusion_config){
        .units = units_of_um(1000),
        .settings = {.policy = policy, .frame_us = 20000, .ahead_us = 400000, .fade_us = 100000}};
    CHECK(occlusion_init_shadows(&occlusion, &config, &sight));
    desk_configure();
    desk_start(0);
    pump_occlusion_attach(&stage, &desk_loop.pump, &occlusion, all);
    ticks(50);
}

static bool push(uint32_t id, int64_t x_m, int64_t y_m) {
    const struct target_update update = {.kind = TARGET_POSITION,
                                         .id = id,
                                         .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                         .position_um = {x_m * METRE, y_m * METRE, 0}};
    return pump_push(&desk_loop.pump, &update);
}

/// Where the controller looks, in thousandths: east to north.
static int64_t slope(void) {
    const struct vec3 ahead = desk_loop.pump.output.status.framing.ahead_q30;
    return ahead.y == 0 ? 0 : (int64_t)ahead.x * 1000 / ahead.y;
}

static uint32_t framed(void) {
    return desk_loop.pump.output.status.framing.framed_count;
}

static void hidden_targets_are_dropped(void) {
    for (int all = 0; all < 2; all++) {
        begin(OCCLUSION_DROP, all != 0);
        CHECK(push(1, -4, 20) && push(2, 8, 20));
        ticks(100);
        CHECK_EQ(desk_loop.pump.output.status.target_count, 2);
        CHECK_EQ(framed(), 1);
        CHECK_EQ(slope(), -200);
        CHECK(push(2, 8, 9)); // before the wall
        ticks(100);
        CHECK_EQ(framed(), 2);
        CHECK(slope() > 200);
    }
}

/// A frame of 40 targets reaches the controller in ticks that follow each other.
static void a_frame_comes_in_one_piece(void) {
    begin(OCCLUSION_CALM, true);
    for (uint32_t id = 0; id < 40U; id++) {
        CHECK(push(id, -(int64_t)id, 20));
    }
    uint32_t counts[4] = {0}, seen = 0;
    for (int i = 0; i < 60 && seen < 4U; i++) {
        ticks(1);
        const uint32_t count = desk_loop.pump.input.update_count;
        if (count != 0U || seen != 0U) {
            counts[seen++] = count;
        }
    }
    CHECK(counts[0] == 16U && counts[1] == 16U && counts[2] == 8U && counts[3] == 0U);
}

/// What somebody aims at by hand is not hidden, and takes the place of all else at once.
static void an_aim_by_hand(void) {
    begin(OCCLUSION_DROP, true);
    CHECK(push(1, -4, 20) && push(2, -5, 20));
    ticks(60);
    CHECK_EQ(framed(), 2);
    const struct target_update clear = {.kind = TARGET_CLEAR},
                               hand = {.kind = TARGET_POSITION,
                                       .id = 9,
                                       .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                       .position_um = {8 * METRE, 20 * METRE, 0}};
    CHECK(pump_push_as_is(&desk_loop.pump, &clear) && pump_push_as_is(&desk_loop.pump, &hand));
    ticks(2);
    CHECK(framed() == 1U && desk_loop.pump.output.status.target_count == 1U);
    CHECK_NEAR(slope(), 400, 1);
    ticks(100);
    CHECK(framed() == 1U);
    CHECK_NEAR(slope(), 400, 1);
    CHECK(push(1, -4, 20));
    ticks(60);
    CHECK_EQ(framed(), 2);
    pump_forget(&desk_loop.pump);
    ticks(1);
    CHECK_EQ(occlusion.target_count, 0);
}

static void gone_and_cleared(void) {
    begin(OCCLUSION_DROP, true);
    CHECK(push(1, -4, 20) && push(2, -5, 20));
    ticks(60);
    const struct target_update gone = {.kind = TARGET_GONE, .id = 1},
                               clear = {.kind = TARGET_CLEAR};
    CHECK(pump_push(&desk_loop.pump, &gone));
    ticks(2);
    CHECK_EQ(desk_loop.pump.output.status.target_count, 1);
    CHECK(pump_push(&desk_loop.pump, &clear));
    ticks(2);
    CHECK_EQ(desk_loop.pump.output.status.target_count, 1); // it may be told again yet
    ticks(60);
    CHECK_EQ(desk_loop.pump.output.status.target_count, 0);
}

/// With a pan to one object each is framed by itself.
static void a_pan_to_one_object(void) {
    begin(OCCLUSION_CALM, true);
    CHECK(push(1, -4, 20));
    ticks(60);
    CHECK(!occlusion.by_object);
    pump_pan(&desk_loop.pump, &(struct controller_pan){.choice = {.one_object = true}});
    ticks(2);
    CHECK(occlusion.by_object);
    pump_pan(&desk_loop.pump, &(struct controller_pan){.choice = {.one_object = false}});
    ticks(2);
    CHECK(!occlusion.by_object);
}

/// The clock of 32 bits turns over after 71 minutes: the frames go on.
static void the_clock_turns_over(void) {
    begin(OCCLUSION_DROP, true);
    desk.now_us = UINT32_MAX - 50000U;
    stage.read_us = desk.now_us;
    CHECK(push(1, -4, 20));
    ticks(200);
    CHECK_NEAR(slope(), -200, 1);
    CHECK(push(1, -8, 20));
    ticks(60);
    CHECK(slope() < -390); // and on, at the speed with which it came there
}

int main(void) {
    TEST(hidden_targets_are_dropped);
    TEST(a_frame_comes_in_one_piece);
    TEST(an_aim_by_hand);
    TEST(gone_and_cleared);
    TEST(a_pan_to_one_object);
    TEST(the_clock_turns_over);
    return check_finish();
}

/// firmware/motion/tracker on ramps, jumps and silence.
#include "check.h"

#include "motion/tracker.h"

#define TURN  (INT64_C(1) << 48)
#define MILLI (TURN / 360000) // a thousandth of a degree
#define NEVER (TURN * 4096)
#define HALF  UINT32_C(32768)
#define EVER  UINT32_MAX

static uint64_t seed = UINT64_C(0x72AC);
static struct tracker tracker;

static void start(void) {
    for (size_t i = 0; i < sizeof tracker; i++) {
        ((uint8_t *)&tracker)[i] = 0xC3;
    }
    tracker_reset(&tracker);
}

static void advance(const struct tracker_config *config, int ticks) {
    for (int i = 0; i < ticks; i++) {
        tracker_advance(&tracker, config);
    }
}

static void nothing_before_the_first_goal(void) {
    const struct tracker_config config = {MILLI, HALF, 100};
    start();
    CHECK(!tracker.valid);
    advance(&config, 10);
    CHECK(!tracker.valid);
    CHECK_EQ(tracker.position_q48, 0);
    tracker_update(&tracker, &config, -5 * TURN);
    CHECK(tracker.valid);
    CHECK_EQ(tracker.position_q48, -5 * TURN);
    CHECK_EQ(tracker.rate_q48, 0);
    advance(&config, 7);
    CHECK_EQ(tracker.goal_q48, -5 * TURN);
    CHECK_EQ(tracker.position_q48, -5 * TURN);
    CHECK_EQ(tracker.age_ticks, 7);
    tracker_reset(&tracker);
    CHECK(!tracker.valid);
}

static void without_memory_each_goal_is_taken_as_it_comes(void) {
    const struct tracker_config config = {NEVER, 0, EVER};
    start();
    tracker_update(&tracker, &config, 1000);
    advance(&config, 10);
    tracker_update(&tracker, &config, 1500);
    CHECK_EQ(tracker.position_q48, 1500);
    CHECK_EQ(tracker.rate_q48, 50);
    advance(&config, 4);
    CHECK_EQ(tracker.position_q48, 1700);
    tracker_update(&tracker, &config, 1300);
    CHECK_EQ(tracker.position_q48, 1300);
    CHECK_EQ(tracker.rate_q48, -50); // 50 - 400 / 4
}

/// Memory 1/2: alpha 3/4, beta 1/4.
static void half_memory_by_hand(void) {
    const struct tracker_config config = {NEVER, HALF, EVER};
    start();
    tracker_update(&tracker, &config, 0);
    advance(&config, 4);
    tracker_update(&tracker, &config, 1600);
    CHECK_EQ(tracker.position_q48, 1200);
    CHECK_EQ(tracker.rate_q48, 100);
    advance(&config, 4); // 1600
    tracker_update(&tracker, &config, 3200);
    CHECK_EQ(tracker.position_q48, 2800);
    CHECK_EQ(tracker.rate_q48, 200);
    advance(&config, 4); // 3600
    tracker_update(&tracker, &config, -1200);
    CHECK_EQ(tracker.position_q48, 0);
    CHECK_EQ(tracker.rate_q48, -100);
}

static void fractions_are_rounded_to_nearest(void) {
    const struct tracker_config config = {NEVER, HALF, EVER};
    const int64_t surprise[] = {1, 2, 3, 4, 65537, -1, -2, -3, -65537};
    const int64_t taken[] = {1, 2, 2, 3, 49153, -1, -2, -2, -49153}; // three quarters
    for (unsigned i = 0; i < 9U; i++) {
        start();
        tracker_update(&tracker, &config, 0);
        advance(&config, 1);
        tracker_update(&tracker, &config, surprise[i]);
        CHECK_EQ(tracker.position_q48, taken[i]);
    }
}

/// On a ramp the prediction error dies out, at every spacing of the goals and with every memory.
static void ramps_are_followed_without_lag(void) {
    const uint32_t memories[] = {0, 6554, HALF, 52429};
    for (unsigned m = 0; m < 4U; m++) {
        for (int spacing = 1; spacing <= 64 && check_clean(); spacing = spacing * 2 + 1) {
            const struct tracker_config config = {TURN / 8, memories[m], 200};
            const int64_t rate = (m % 2U == 0U ? 60 : -47) * MILLI + 12345; // a tick
            int64_t goal = 3 * TURN;
            start();
            tracker_update(&tracker, &config, goal);
            for (int i = 1; i < 200 * spacing && check_clean(); i++) {
                goal += rate;
                tracker_advance(&tracker, &config);
                if (i > 120 * spacing) { // also between the goals
                    CHECK_NEAR(tracker.position_q48, goal, 200 + 40 * spacing);
                    CHECK_NEAR(tracker.rate_q48, rate, 40);
                }
                if (i % spacing == 0) {
                    tracker_update(&tracker, &config, goal);
                }
            }
        }
    }
}

static void jumps_are_new_goals_at_rest(void) {
    const struct tracker_config config = {1000, HALF, EVER};
    for (int64_t sign = -1; sign <= 1; sign += 2) {
        start();
        tracker_update(&tracker, &config, 0);
        advance(&config, 1);
        tracker_update(&tracker, &config, sign * 800);
        CHECK_EQ(tracker.rate_q48, sign * 200);
        advance(&config, 1);                            // at 800
        tracker_update(&tracker, &config, sign * 1800); // just no jump
        CHECK_EQ(tracker.position_q48, sign * 1550);
        CHECK_EQ(tracker.rate_q48, sign * 450);
        advance(&config, 1); // at 2000
        tracker_update(&tracker, &config, sign * 3001);
        CHECK_EQ(tracker.position_q48, sign * 3001);
        CHECK_EQ(tracker.rate_q48, 0);
        CHECK(tracker.valid);
        advance(&config, 1);
        tracker_update(&tracker, &config, sign * 2000); // 1001 back
        CHECK_EQ(tracker.position_q48, sign * 2000);
        CHECK_EQ(tracker.rate_q48, 0);
    }
}

static void a_rate_is_believed_for_the_coast_time(void) {
    const struct tracker_config config = {NEVER, 0, 10};
    start();
    tracker_update(&tracker, &config, 0);
    advance(&config, 1);
    tracker_update(&tracker, &config, 100);
    advance(&config, 10);
    CHECK_EQ(tracker.position_q48, 1100);
    CHECK_EQ(tracker.rate_q48, 100);
    advance(&config, 1);
    CHECK_EQ(tracker.position_q48, 1100);
    CHECK_EQ(tracker.rate_q48, 0);
    advance(&config, 899);
    CHECK_EQ(tracker.position_q48, 1100);
    tracker_update(&tracker, &config, 100 + 910 * 2);
    CHECK_EQ(tracker.position_q48, 1920);
    CHECK_EQ(tracker.rate_q48, 0); // (1920 - 1100) / 910
    tracker_update(&tracker, &config, 3000);

    const struct tracker_config no_coast = {NEVER, 0, 0};
    start();
    tracker_update(&tracker, &no_coast, 0);
    advance(&no_coast, 1);
    tracker_update(&tracker, &no_coast, 100);
    advance(&no_coast, 1);
    CHECK_EQ(tracker.position_q48, 100);
}

/// Without news for long the goal is where it was last given, not where it was smoothed or coasted
/// to.
static void a_goal_returns_to_where_it_was_last_seen(void) {
    const struct tracker_config config = {NEVER, HALF, 10};
    start();
    tracker_update(&tracker, &config, 0);
    advance(&config, 1);
    tracker_update(&tracker, &config, 400);
    CHECK_EQ(tracker.position_q48, 300);
    advance(&config, 10 + TRACKER_RETURN_TICKS);
    CHECK_EQ(tracker.position_q48, 1300);
    advance(&config, 1);
    CHECK_EQ(tracker.position_q48, 400);
    CHECK_EQ(tracker.rate_q48, 0);
    advance(&config, 5000);
    CHECK_EQ(tracker.position_q48, 400);
    tracker_update(&tracker, &config, 800);
    CHECK_EQ(tracker.position_q48, 700);
}

static void a_very_long_silence(void) {
    const struct tracker_config config = {NEVER, 0, 10};
    start();
    tracker_update(&tracker, &config, 0);
    tracker.age_ticks = UINT32_MAX;
    advance(&config, 3);
    CHECK_EQ(tracker.age_ticks, UINT32_MAX);
    tracker_update(&tracker, &config, TURN);
    CHECK_EQ(tracker.rate_q48, TURN / UINT32_MAX);
}

static void a_second_goal_in_one_tick_replaces_the_first(void) {
    const struct tracker_config config = {NEVER, HALF, 100};
    start();
    tracker_update(&tracker, &config, 0);
    advance(&config, 1);
    tracker_update(&tracker, &config, 400);
    tracker_update(&tracker, &config, 5000);
    CHECK_EQ(tracker.position_q48, 5000);
    CHECK_EQ(tracker.rate_q48, 100);
}

/// Wide jumps, long silences and the largest memory: no overflow (the sanitizers watch).
static void extremes(void) {
    const struct tracker_config configs[] = {
        {TURN * 4096, 0, EVER}, {TURN * 4096, HALF, 3}, {TURN * 4096, 65535, EVER}, {0, 0, 0}};
    for (unsigned c = 0; c < 4U; c++) {
        start();
        int64_t goal = -16 * TURN;
        for (int i = 0; i < 20000 && check_clean(); i++) {
            if (check_random(&seed) % 8U == 0U) {
                goal = (check_random(&seed) & 1U) != 0U ? 16 * TURN : -16 * TURN;
                tracker_update(&tracker, &configs[c], goal);
            }
            if (check_random(&seed) % 500U == 0U) {
                tracker.age_ticks = UINT32_MAX - 1U;
            }
            tracker_advance(&tracker, &configs[c]);
            CHECK_NEAR(tracker.position_q48, 0, 4097 * TURN);
            CHECK_NEAR(tracker.rate_q48, 0, TURN);
        }
    }
}

/// A noisy point at rest: the more memory, the quieter.
static void memory_quietens_noise(void) {
    check_note("seed", (int64_t)seed);
    const uint32_t memories[] = {0, HALF, 52429, 62259};
    int64_t last = INT64_MAX;
    for (unsigned m = 0; m < 4U; m++) {
        const struct tracker_config config = {TURN / 8, memories[m], 100};
        start();
        int64_t sum = 0;
        for (int i = 0; i < 4000; i++) {
            const int64_t noise = (int64_t)(check_random(&seed) % 2001U) - 1000;
            tracker_advance(&tracker, &config);
            tracker_update(&tracker, &config, noise * (1 << 20));
            const int64_t off = i > 500 ? tracker.position_q48 / (1 << 20) : 0;
            sum += off * off;
        }
        check_note("mean square of the noise left", sum / 3500);
        CHECK(sum / 3 < last / 4); // by theory 0.63, 0.25 and 0.05 of the first
        last = sum;
    }
}

int main(void) {
    TEST(nothing_before_the_first_goal);
    TEST(without_memory_each_goal_is_taken_as_it_comes);
    TEST(half_memory_by_hand);
    TEST(fractions_are_rounded_to_nearest);
    TEST(ramps_are_followed_without_lag);
    TEST(jumps_are_new_goals_at_rest);
    TEST(a_rate_is_believed_for_the_coast_time);
    TEST(a_goal_returns_to_where_it_was_last_seen);
    TEST(a_very_long_silence);
    TEST(a_second_goal_in_one_tick_replaces_the_first);
    TEST(extremes);
    TEST(memory_quietens_noise);
    return check_finish();
}

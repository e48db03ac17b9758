/// firmware/motion/limiter: its bounds at every tick of random and hostile goals, arrival, lag.
///
/// The second stage is a mean rounded to a whole unit (2^-48 of a turn). So its speed keeps the
/// bound exactly, its acceleration to 1 unit and its jerk to 3 units a tick.
#include "check.h"

#include "motion/limiter.h"

static uint64_t seed;
static struct limiter_config config;
static struct limiter limiter;

static int64_t size_of(int64_t value) {
    return value < 0 ? -value : value;
}

static int64_t any(unsigned bits) {
    const int64_t size = (int64_t)(check_random(&seed) >> (64U - bits));
    const int64_t small = size >> (check_random(&seed) % bits);
    return (check_random(&seed) & 1U) != 0U ? small : -small;
}

static int64_t any_above_0(unsigned bits) {
    const int64_t size = size_of(any(bits));
    return size == 0 ? 1 : size;
}

static void reset(int64_t position) {
    for (size_t i = 0; i < sizeof limiter; i++) {
        ((uint8_t *)&limiter)[i] = 0x5A;
    }
    limiter_reset(&limiter, &config, position);
}

// ---------------------------------------------------------------- braking

static int64_t stopping_distance(int64_t speed, int64_t accel) {
    int64_t distance = 0;
    for (; speed > 0; speed -= accel) {
        distance += speed;
    }
    return distance;
}

static void brake_speed_is_the_largest(void) {
    for (int64_t accel = 1; accel <= 9; accel++) {
        for (int64_t distance = 0; distance < 400 && check_clean(); distance++) {
            const int64_t speed = limiter_brake_speed(distance, accel);
            CHECK(stopping_distance(speed, accel) <= distance);
            CHECK(stopping_distance(speed + 1, accel) > distance);
        }
    }
    seed = 11;
    for (int i = 0; i < CHECK_ROUNDS(20000) && check_clean(); i++) {
        const int64_t accel = any_above_0(49);
        int64_t distance = size_of(any(56));
        if (distance / accel > 1000000) {
            distance %= 1000000 * accel; // so that the sum below ends soon
        }
        const int64_t speed = limiter_brake_speed(distance, accel);
        CHECK(stopping_distance(speed, accel) <= distance);
        CHECK(stopping_distance(speed + 1, accel) > distance);
    }
    CHECK_EQ(limiter_brake_speed(0, 1), 0);
    CHECK_EQ(limiter_brake_speed(INT64_C(1) << 56, INT64_C(1) << 48),
             ((INT64_C(256) << 48) + (INT64_C(253) << 48)) / 23);
    // 2^28 * sqrt(2) ticks of braking: v = 2^28 sqrt(2) - 1/2.
    CHECK_EQ(limiter_brake_speed(INT64_C(1) << 56, 1), 379625061);
}

// ---------------------------------------------------------------- every tick

/// The last positions of the first stage and the last outputs, kept apart from the limiter's own.
static struct {
    int64_t first[LIMITER_SMOOTH_TICKS_MAX];
    uint32_t next;
    int64_t position, speed, output, output_speed, output_accel;
    int64_t worst_accel, worst_jerk; ///< beyond the exact bounds, in units
} past;

static void begin(int64_t position) {
    reset(position);
    for (uint32_t i = 0; i < LIMITER_SMOOTH_TICKS_MAX; i++) {
        past.first[i] = position;
    }
    past.next = 0;
    past.position = past.output = position;
    past.speed = past.output_speed = past.output_accel = 0;
}

static int64_t mean_of_past(void) {
    const int64_t count = config.smooth_ticks;
    int64_t whole = 0, rest = 0;
    for (uint32_t i = 0; i < config.smooth_ticks; i++) {
        whole += past.first[i] / count;
        rest += past.first[i] % count;
    }
    whole += rest / count;
    rest %= count;
    return whole - (rest < 0 ? 1 : 0); // rounded down on both sides of zero
}

static bool is_inside(int64_t position) {
    return position >= config.min_q48 && position <= config.max_q48;
}

/// Outside the limits a step may only lead inward (or stand).
static bool leads_inward(int64_t from, int64_t to) {
    return (is_inside(to)) || (from < config.min_q48 && to >= from && to <= config.max_q48) ||
           (from > config.max_q48 && to <= from && to >= config.min_q48);
}

/// One tick, and everything that must hold after it.
static void step(bool stop, int64_t goal, int64_t rate) {
    const int64_t output = stop ? limiter_stop(&limiter) : limiter_follow(&limiter, goal, rate);
    const int64_t accel = size_of(limiter.speed_q48 - past.speed);
    CHECK(leads_inward(past.position, limiter.position_q48));
    CHECK(leads_inward(past.output, output));
    CHECK_EQ(limiter.position_q48, past.position + limiter.speed_q48);
    CHECK(size_of(limiter.speed_q48) <= config.speed_max_q48);
    CHECK(accel <= config.accel_max_q48);
    // It can always stop: within the limits, or (outside) before it has left them on the far side.
    const int64_t room = limiter.speed_q48 > 0 ? config.max_q48 - limiter.position_q48
                                               : limiter.position_q48 - config.min_q48;
    const int64_t next = size_of(limiter.speed_q48) - config.accel_max_q48;
    CHECK(next <= 0 || next <= limiter_brake_speed(room, config.accel_max_q48));

    past.first[past.next] = limiter.position_q48;
    past.next = (past.next + 1U) % config.smooth_ticks;
    CHECK_EQ(output, mean_of_past());
    CHECK_EQ(output, limiter.output_q48);
    const int64_t speed = output - past.output;
    CHECK_EQ(limiter.output_speed_q48, speed);
    CHECK(size_of(speed) <= config.speed_max_q48);
    const int64_t output_accel = speed - past.output_speed;
    const int64_t jerk = output_accel - past.output_accel;
    const int64_t jerk_max = 2 * config.accel_max_q48 / (int64_t)config.smooth_ticks;
    const int64_t over_accel = size_of(output_accel) - config.accel_max_q48,
                  over_jerk = size_of(jerk) - jerk_max;
    CHECK(over_accel <= (config.smooth_ticks == 1U ? 0 : 1));
    CHECK(over_jerk <= (config.smooth_ticks == 1U ? 0 : 4)); // 3 and what jerk_max was rounded down
    past.worst_accel = over_accel > past.worst_accel ? over_accel : past.worst_accel;
    past.worst_jerk = over_jerk > past.worst_jerk ? over_jerk : past.worst_jerk;
    past.position = limiter.position_q48;
    past.speed = limiter.speed_q48;
    past.output = output;
    past.output_speed = speed;
    past.output_accel = output_accel;
}

/// Limits, speeds and lengths of every size. Units from single counts (where rounding shows) up.
static void any_config(void) {
    const unsigned bits = 2U + (unsigned)(check_random(&seed) % 51U);
    const int64_t a = any(bits), other = any(bits);
    const int64_t b = check_random(&seed) % 8U == 0U ? a : other;
    const int64_t speed = any_above_0(bits < 48U ? bits : 48U);
    const int64_t accel = any_above_0(bits < 48U ? bits : 48U);
    const unsigned shift = 56U + (unsigned)(check_random(&seed) % 8U);
    const uint32_t smooth = 1U + (uint32_t)(check_random(&seed) >> shift);
    config = (struct limiter_config){a < b ? a : b, a < b ? b : a, speed, accel, smooth};
}

/// Goals inside, at the limits, far outside, at the ends of the type; rates alike.
static int64_t any_goal(void) {
    switch (check_random(&seed) % 8U) {
    case 0:
        return config.min_q48;
    case 1:
        return config.max_q48;
    case 2:
        return limiter.position_q48 + any(8);
    case 3:
        return any(63);
    case 4:
        return (check_random(&seed) & 1U) != 0U ? INT64_MAX : INT64_MIN;
    default:
        return config.min_q48 +
               (int64_t)(check_random(&seed) % ((uint64_t)(config.max_q48 - config.min_q48) + 1U));
    }
}

static int64_t any_rate(void) {
    switch (check_random(&seed) % 6U) {
    case 0:
        return (check_random(&seed) & 1U) != 0U ? INT64_MAX : INT64_MIN;
    case 1:
        return any(48);
    case 2:
        return config.speed_max_q48;
    case 3:
        return any(8);
    default:
        return 0;
    }
}

static void run_hostile(int64_t start, int ticks) {
    begin(start);
    int64_t goal = start, rate = 0;
    bool stop = false;
    uint64_t change_every = 1U + check_random(&seed) % 200U;
    for (int i = 0; i < ticks && check_clean(); i++) {
        if (check_random(&seed) % change_every == 0U) {
            goal = any_goal();
            rate = any_rate();
            stop = check_random(&seed) % 8U == 0U;
        }
        if (check_random(&seed) % 300U == 0U) {
            change_every = 1U + check_random(&seed) % 200U;
        }
        step(stop, goal, rate);
    }
}

static void note_run(void) {
    check_note("seed", (int64_t)seed);
    past.worst_accel = past.worst_jerk = INT64_MIN;
}

static void note_worst(void) {
    check_note("output acceleration above the bound, units, most", past.worst_accel);
    check_note("output jerk above the bound, units, most", past.worst_jerk);
}

static void hostile_goals(void) {
    seed = 21;
    note_run();
    for (int i = 0; i < CHECK_ROUNDS(250) && check_clean(); i++) {
        any_config();
        run_hostile(config.min_q48 + (int64_t)(check_random(&seed) %
                                               ((uint64_t)(config.max_q48 - config.min_q48) + 1U)),
                    600);
        CHECK(is_inside(limiter.position_q48) && is_inside(limiter.output_q48));
    }
    note_worst();
}

static void starting_outside_leads_inward(void) {
    seed = 22;
    note_run();
    for (int i = 0; i < CHECK_ROUNDS(150) && check_clean(); i++) {
        any_config();
        const int64_t off = any_above_0(54);
        run_hostile((check_random(&seed) & 1U) != 0U ? config.max_q48 + off : config.min_q48 - off,
                    600);
    }
    // Far outside (what drive.h lets pass), with the longest mean.
    config = (struct limiter_config){-(INT64_C(1) << 52), INT64_C(1) << 52, INT64_C(1) << 48,
                                     INT64_C(1) << 48, LIMITER_SMOOTH_TICKS_MAX};
    run_hostile(INT64_C(1) << 54, 400);
    run_hostile(-(INT64_C(1) << 54), 400);
}

static void limits_that_equal_each_other(void) {
    config = (struct limiter_config){500, 500, 1000, 1000, 7};
    begin(500);
    for (int i = 0; i < 50 && check_clean(); i++) {
        step(false, i * 1000 - 20000, i * 100 - 2000);
        CHECK_EQ(limiter.output_q48, 500);
    }
    begin(-40000);
    for (int i = 0; i < 100 && check_clean(); i++) {
        step(false, 70000, 0);
    }
    CHECK_EQ(limiter.output_q48, 500);
    CHECK(limiter_at_rest(&limiter));
}

// ---------------------------------------------------------------- arrival

/// Fewest ticks from rest to rest over a distance: speeds 1a, 2a, ... v ... 2a, 1a at most.
static int64_t fewest_ticks(int64_t distance) {
    for (int64_t ticks = 0;; ticks++) {
        int64_t reach = 0;
        for (int64_t k = 1; k <= ticks; k++) {
            const int64_t ramp = config.accel_max_q48 * (k < ticks + 1 - k ? k : ticks + 1 - k);
            reach += ramp < config.speed_max_q48 ? ramp : config.speed_max_q48;
        }
        if (reach >= distance) {
            return ticks;
        }
    }
}

/// Ticks from rest at `from` until the output rests at `to`.
static int64_t travel(int64_t from, int64_t to) {
    begin(from);
    int64_t ticks = 0;
    while (!(limiter.output_q48 == to && limiter_at_rest(&limiter)) && ticks < 20000) {
        step(false, to, 0);
        ticks++;
    }
    return ticks;
}

static void arrives_exactly_and_soon(void) {
    seed = 31;
    check_note("seed", (int64_t)seed);
    int64_t worst = 0;
    for (int i = 0; i < CHECK_ROUNDS(150) && check_clean(); i++) {
        const int64_t speed = any_above_0(40);
        const int64_t accel = any_above_0(36);
        const uint32_t smooth = 1U + (uint32_t)(check_random(&seed) % 100U);
        config =
            (struct limiter_config){-(INT64_C(1) << 50), INT64_C(1) << 50, speed, accel, smooth};
        if (config.speed_max_q48 / config.accel_max_q48 > 300) {
            config.speed_max_q48 = config.accel_max_q48 * 300;
        }
        const int64_t from = any(45);
        const int64_t distance =
            (int64_t)(check_random(&seed) % (uint64_t)(config.speed_max_q48 * 300 + 2));
        const int64_t to = (check_random(&seed) & 1U) != 0U ? from + distance : from - distance;
        const int64_t fewest = fewest_ticks(distance);
        const int64_t ticks = travel(from, to);
        CHECK_EQ(limiter.output_q48, to);
        const int64_t mean = distance == 0 ? 0 : (int64_t)smooth;
        CHECK(ticks >= fewest + mean);
        worst = ticks - fewest - mean > worst ? ticks - fewest - mean : worst;
    }
    check_note("ticks above the fewest possible, most", worst);
    CHECK_EQ(worst, 0);
}

/// 60 degrees a second, 400 a second^2, 8000 a second^3, 1 ms a tick.
static void use_a_real_gimbal(void) {
    const int64_t degree = (INT64_C(1) << 48) / 360;
    config = (struct limiter_config){-180 * degree, 180 * degree, degree * 60 / 1000,
                                     degree * 400 / 1000000, 100};
}

static void stops_within_a_quarter_second(void) {
    use_a_real_gimbal();
    begin(0);
    for (int i = 0; i < 1000; i++) {
        step(false, config.max_q48, 0);
    }
    CHECK_EQ(limiter.output_speed_q48, config.speed_max_q48);
    int64_t ticks = 0;
    const int64_t from = limiter.output_q48;
    while (!limiter_at_rest(&limiter) && ticks < 1000) {
        step(true, 0, 0);
        ticks++;
    }
    check_note("ticks to standstill from 60 degrees a second", ticks);
    CHECK(ticks <= 250);
    CHECK_NEAR(limiter.output_q48 - from, config.speed_max_q48 * 125, config.speed_max_q48);
    for (int i = 0; i < 300; i++) {
        step(true, 0, 0);
        CHECK(limiter_at_rest(&limiter));
    }
}

/// "At rest" must mean that the output stands from now on.
static void rest_is_rest(void) {
    seed = 33;
    for (int i = 0; i < 300 && check_clean(); i++) {
        const int64_t speed = 1 + (int64_t)(check_random(&seed) % 40U);
        const int64_t accel = 1 + (int64_t)(check_random(&seed) % 40U);
        const uint32_t smooth = 1U + (uint32_t)(check_random(&seed) % 9U);
        config = (struct limiter_config){-100, 100, speed, accel, smooth};
        begin(0);
        for (int k = 0; k < 400 && check_clean(); k++) {
            step(false, (int64_t)(check_random(&seed) % 21U) - 10, 0);
            if (limiter_at_rest(&limiter)) {
                const struct limiter moving = limiter;
                for (uint32_t t = 0; t < config.smooth_ticks; t++) {
                    CHECK_EQ(limiter_stop(&limiter), moving.output_q48);
                }
                limiter = moving;
            }
        }
    }
}

// ---------------------------------------------------------------- following

static void follows_a_ramp_without_lag(void) {
    use_a_real_gimbal();
    const int64_t rates[] = {config.speed_max_q48 / 3, -config.speed_max_q48 / 2, 12345, -1,
                             config.speed_max_q48 - 1};
    for (unsigned r = 0; r < sizeof rates / sizeof *rates; r++) {
        for (uint32_t smooth = 1; smooth <= 256U; smooth += 51U) {
            config.smooth_ticks = smooth;
            int64_t goal = -rates[r] * 900;
            begin(goal);
            for (int i = 0; i < 1500 && check_clean(); i++) {
                goal += rates[r];
                step(false, goal, rates[r]);
                if (i > 900 && rates[r] < config.speed_max_q48 * 9 / 10) {
                    CHECK_NEAR(limiter.output_q48, goal, 1);
                }
            }
        }
    }
}

/// A ramp that ends, or passes a limit, leaves no error and no overshoot beyond the limits.
static void ramps_end(void) {
    use_a_real_gimbal();
    const int64_t rate = config.speed_max_q48 / 2;
    begin(0);
    int64_t goal = 0;
    for (int i = 0; i < 1000; i++) {
        goal += rate;
        step(false, goal, rate);
    }
    for (int i = 0; i < 1000; i++) {
        step(false, goal, 0);
    }
    CHECK_EQ(limiter.output_q48, goal);
    for (int i = 0; i < 12000; i++) {
        goal += rate;
        step(false, goal, rate);
    }
    CHECK_EQ(limiter.output_q48, config.max_q48);
    CHECK(limiter_at_rest(&limiter));
    for (int i = 0; i < 3000; i++) { // far beyond, on the way back
        step(false, config.max_q48 * 3 - rate * i, -rate);
        CHECK_EQ(limiter.output_q48, config.max_q48);
    }
    // Faster than the axis can go: as fast as it can.
    begin(0);
    for (int64_t i = 0; i < 2000; i++) {
        step(false, i * config.speed_max_q48 * 3, config.speed_max_q48 * 3);
    }
    CHECK_EQ(limiter.output_speed_q48, config.speed_max_q48);
}

int main(void) {
    TEST(brake_speed_is_the_largest);
    TEST(hostile_goals);
    TEST(starting_outside_leads_inward);
    TEST(limits_that_equal_each_other);
    TEST(arrives_exactly_and_soon);
    TEST(stops_within_a_quarter_second);
    TEST(rest_is_rest);
    TEST(follows_a_ramp_without_lag);
    TEST(ramps_end);
    return check_finish();
}

/// firmware/motion/axis: turns counted through the seam, against a search of every turn.
#include "check.h"

#include "motion/axis.h"

#define TURN   AXIS_TURN_Q48
#define DEGREE (AXIS_TURN_Q48 / 360)

static uint64_t seed = UINT64_C(0xA815);

/// -2^bits < result < 2^bits, every size.
static int64_t any(unsigned bits) {
    const int64_t size = (int64_t)(check_random(&seed) >> (64U - bits));
    const int64_t small = size >> (check_random(&seed) % bits);
    return (check_random(&seed) & 1U) != 0U ? small : -small;
}

static int64_t size_of(int64_t value) {
    return value < 0 ? -value : value;
}

static void turns_are_dropped_and_rounded(void) {
    CHECK_EQ(axis_to_bam32(0).bam, 0);
    CHECK_EQ(axis_to_bam32(TURN).bam, 0);
    CHECK_EQ(axis_to_bam32(-TURN).bam, 0);
    CHECK_EQ(axis_to_bam32(5 * TURN / 4).bam, BAM32_QUARTER);
    CHECK_EQ(axis_to_bam32(-TURN / 4).bam, 3U * BAM32_QUARTER);
    CHECK_EQ(axis_to_bam32((1 << 15) - 1).bam, 0);
    CHECK_EQ(axis_to_bam32(1 << 15).bam, 1);
    CHECK_EQ(axis_to_bam32(-(1 << 15)).bam, 0);
    CHECK_EQ(axis_to_bam32(-(1 << 15) - 1).bam, UINT32_MAX);
    CHECK_EQ(axis_to_bam32(TURN - 1).bam, 0);
    CHECK_EQ(axis_to_bam32(INT64_MAX).bam, 0);
    CHECK_EQ(axis_to_bam32(INT64_MIN).bam, 0);
    CHECK_EQ(axis_from_bam(INT32_MIN), -TURN / 2);
    CHECK_EQ(axis_from_bam(INT32_MAX), TURN / 2 - (1 << 16));
    for (int i = 0; i < 10000 && check_clean(); i++) {
        const int32_t bam = (int32_t)any(32);
        CHECK_EQ(axis_to_bam32(axis_from_bam(bam)).bam, (uint32_t)bam);
        CHECK_EQ(axis_to_bam32(axis_from_bam(bam) + any(15)).bam, (uint32_t)bam);
    }
}

static int64_t unwrap_degrees(int angle, int from, int min, int max) {
    const int64_t q48 =
        axis_unwrap(axis_to_bam32(angle * DEGREE), from * DEGREE, min * DEGREE, max * DEGREE);
    return (q48 + (q48 < 0 ? -DEGREE : DEGREE) / 2) / DEGREE;
}

static void the_short_way_inside(void) {
    CHECK_EQ(unwrap_degrees(10, 350, -720, 720), 370); // through the seam
    CHECK_EQ(unwrap_degrees(350, 10, -720, 720), -10);
    CHECK_EQ(unwrap_degrees(-170, 170, -270, 270), 190);
    CHECK_EQ(unwrap_degrees(-170, 170, -180, 180), -170); // the cable asks for the long way
    CHECK_EQ(unwrap_degrees(90, 500, -720, 720), 450);
    CHECK_EQ(unwrap_degrees(0, 719, -721, 721), 720);
    CHECK_EQ(unwrap_degrees(180, 0, -720, 720) == 180 || unwrap_degrees(180, 0, -720, 720) == -180,
             true);
}

static void starting_outside(void) {
    CHECK_EQ(unwrap_degrees(0, 900, -180, 180), 0);
    CHECK_EQ(unwrap_degrees(90, 900, -400, 400), 90); // the greatest one inside
    CHECK_EQ(unwrap_degrees(30, 900, -400, 400), 390);
    CHECK_EQ(unwrap_degrees(-90, -900, -400, 400), -90);
}

static void out_of_reach(void) {
    CHECK_EQ(unwrap_degrees(120, 0, -90, 90), 90);
    CHECK_EQ(unwrap_degrees(-120, 0, -90, 90), -90);
    CHECK_EQ(unwrap_degrees(-120, 80, -90, 90), -90); // however far away
    CHECK_EQ(unwrap_degrees(100, 0, -10, 30), 30);
    CHECK_EQ(unwrap_degrees(280, 0, -10, 30), -10);
    CHECK_EQ(unwrap_degrees(12, 0, 5, 5), 5); // limits that equal each other
    CHECK_EQ(unwrap_degrees(5, 99, 5, 5), 5);
}

/// What the header says, by trying every turn.
static void check_by_search(bam32_t angle, int64_t from, int64_t min, int64_t max) {
    const int64_t got = axis_unwrap(angle, from, min, max);
    CHECK(got >= min && got <= max);
    int64_t best = INT64_MAX;
    for (int64_t turn = -40; turn <= 40; turn++) {
        const int64_t at = turn * TURN + ((int64_t)angle.bam << 16);
        if (at >= min && at <= max && size_of(at - from) < best) {
            best = size_of(at - from);
        }
    }
    if (best != INT64_MAX) {
        CHECK_EQ(size_of(got - from), best);
        CHECK_EQ(((uint64_t)got & (uint64_t)(TURN - 1)) >> 16, angle.bam);
        CHECK_EQ(got & 0xFFFF, 0);
        return;
    }
    const int32_t to_min = bam32_diff(angle, axis_to_bam32(min)),
                  to_max = bam32_diff(angle, axis_to_bam32(max));
    CHECK(got == min || got == max);
    // The limits are finer than BAM: a tie may go either way.
    if (size_of(to_min) + 1 < size_of(to_max)) {
        CHECK_EQ(got, min);
    } else if (size_of(to_max) + 1 < size_of(to_min)) {
        CHECK_EQ(got, max);
    }
}

static void random_against_a_search(void) {
    check_note("seed", (int64_t)seed);
    for (int i = 0; i < 20000 && check_clean(); i++) {
        const int64_t a = any(52), b = any(52);
        const bool near = check_random(&seed) % 2U == 0U; // also ranges below a turn
        int64_t low = near || a < b ? a : b, high = near ? a + size_of(any(48)) : (a < b ? b : a);
        if (check_random(&seed) % 2U == 0U) { // limits on a whole BAM, which an angle can hit
            low -= low % (1 << 16);
            high -= high % (1 << 16);
        }
        const bam32_t random = bam32((uint32_t)any(33));
        const bam32_t angles[] = {axis_to_bam32(low), axis_to_bam32(high), random, random};
        const bam32_t angle = angles[check_random(&seed) % 4U];
        check_by_search(angle, any(53), low, high);
    }
}

/// A goal that walks round the circle for ever is followed without a jump of a turn.
static void continuous_through_the_seam(void) {
    int64_t at = 0, walked = 0;
    for (int i = 0; i < 2000 && check_clean(); i++) {
        const int64_t step = i < 1200 ? 3 * DEGREE / 2 : -2 * DEGREE;
        walked += step;
        const int64_t next = axis_unwrap(axis_to_bam32(walked), at, -8 * TURN, 8 * TURN);
        CHECK_NEAR(next - at, step, 1 << 16);
        at = next;
    }
}

static void at_the_ends_of_the_range(void) {
    const int64_t reach = 32767 * TURN;
    CHECK_EQ(axis_unwrap(bam32(BAM32_QUARTER), reach, -reach, reach), reach - 3 * (TURN / 4));
    CHECK_EQ(axis_unwrap(bam32(3U * BAM32_QUARTER), -reach, -reach, reach),
             -reach + 3 * (TURN / 4));
    CHECK_EQ(axis_unwrap(bam32(0), INT64_MIN, -reach, reach), -reach);
    CHECK_EQ(axis_unwrap(bam32(0), INT64_MAX, -reach, reach), reach);
    CHECK_EQ(axis_unwrap(bam32(BAM32_QUARTER), 0, reach, reach), reach);
}

int main(void) {
    TEST(turns_are_dropped_and_rounded);
    TEST(the_short_way_inside);
    TEST(starting_outside);
    TEST(out_of_reach);
    TEST(random_against_a_search);
    TEST(continuous_through_the_seam);
    TEST(at_the_ends_of_the_range);
    return check_finish();
}

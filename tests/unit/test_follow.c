/// firmware/sphere/follow: bounded work, going on in the next call, warm starts. How good its cones
/// are is shown by tests/property/follow_exact.c.
#include "check.h"

#include "fixed/trig.h"
#include "fixed/trig_fine.h"
#include "sphere/follow.h"

#include <stddef.h>

#define COUNT 256U
/// What the controller allows; and what a call may take: the first pass with a second look at every
/// cap, a cap that enters, and the cover.
#define LIMIT       2500U
#define WORK_MOST   (LIMIT + 3500U)
#define POINTS_MOST (LIMIT + 500U)

static struct vec3 centre[COUNT];
static struct follow_radius radius[COUNT];
static uint64_t seed = UINT64_C(0x5EED0031);

static struct vec3 polar(uint32_t round_bam, uint32_t off_bam) {
    const struct sincos a = trig_sincos(bam32(round_bam)), h = trig_sincos(bam32(off_bam));
    return vec3_normalise(
        vec3(q30_mul(a.cos_q30, h.sin_q30), h.cos_q30, q30_mul(a.sin_q30, h.sin_q30)));
}

static void set_radius(uint32_t i, uint32_t bam) {
    const struct sincos s = trig_sincos(bam32(bam));
    radius[i] = (struct follow_radius){bam32(bam), s.sin_q30, s.cos_q30};
}

static uint32_t below(uint32_t bound) {
    return (uint32_t)((check_random(&seed) >> 32) * bound >> 32);
}

enum shape { CAP, CIRCLE, SPIRAL, ARC, SHAPES };

/// 256 centres within 2^-`narrow` of 45 degrees; radii up to a quarter of that.
static void make_set(enum shape shape, unsigned narrow, uint32_t radius_most) {
    const uint32_t off = (BAM32_QUARTER / 2U) >> narrow;
    for (uint32_t i = 0; i < COUNT; i++) {
        switch (shape) {
        case CAP:
            centre[i] = polar(below(UINT32_MAX), below(off));
            break;
        case CIRCLE:
            centre[i] = polar(below(UINT32_MAX), off);
            break;
        case SPIRAL:
            centre[i] = polar(i * UINT32_C(0x13333333), off / COUNT * (i + 1U));
            break;
        default:
            centre[i] = polar(i % 2U * BAM32_HALF, below(off));
            break;
        }
        set_radius(i, radius_most == 0U ? 0U : below(radius_most));
    }
}

static bool holds_all(const struct follow_input *input, const struct follow_result *result) {
    for (uint32_t i = 0; i < COUNT; i++) {
        const uint64_t reach = trig_fine_angle_q30(result->axis_q30, centre[i]) +
                               (input->radius == NULL ? 0U : (uint64_t)radius[i].angle.bam << 32);
        if (reach > ((uint64_t)result->half_angle.bam << 32) + 2048U) {
            return false;
        }
    }
    return true;
}

static struct follow_result last;

static void go_on(struct follow_input *input) {
    input->warm = last.support;
    input->warm_count = (uint8_t)(last.support_count + last.pending);
    input->pending = last.pending;
    input->pending_step = last.pending_step;
}

static enum follow_status call(struct follow_input *input, struct follow_result *result) {
    const enum follow_status status = follow_narrowest(input, result);
    last = *result;
    go_on(input);
    return status;
}

static uint32_t most_points, most_sized, most_calls, most_warm;

/// Calls with a limit until the end: every cone on the way holds all, none takes more than it may.
static void check_set(bool sized) {
    struct follow_input input = {
        .centre_q30 = centre, .radius = sized ? radius : NULL, .count = COUNT};
    struct follow_result at_once, result;
    CHECK_EQ(follow_narrowest(&input, &at_once), FOLLOW_OK);
    input.work_limit = LIMIT;
    uint32_t calls = 0;
    enum follow_status status = FOLLOW_UNFINISHED;
    while (status == FOLLOW_UNFINISHED && calls < 100U) {
        status = call(&input, &result);
        calls++;
        CHECK(result.half_angle.bam == BAM32_HALF || holds_all(&input, &result));
        uint32_t *most = sized ? &most_sized : &most_points;
        *most = result.work > *most ? result.work : *most;
    }
    CHECK_EQ(status, FOLLOW_OK);
    CHECK_NEAR(result.half_angle.bam, at_once.half_angle.bam, 14);
    most_calls = calls > most_calls ? calls : most_calls;
    // Once more, from the support that holds.
    CHECK_EQ(call(&input, &result), FOLLOW_OK);
    most_warm = result.work > most_warm ? result.work : most_warm;
}

static void work_is_bounded_and_ends(void) {
    for (unsigned shape = 0; shape < SHAPES; shape++) {
        for (unsigned narrow = 0; narrow < 26U && check_clean(); narrow++) {
            for (unsigned sized = 0; sized < 3U && check_clean(); sized++) {
                make_set((enum shape)shape, narrow,
                         sized == 2U ? (BAM32_QUARTER / 8U) >> narrow : 0U);
                check_set(sized != 0U);
            }
        }
    }
    check_note("work of a call with points, most", most_points);
    check_note("work of a call with radii, most", most_sized);
    check_note("work of a warm call, most", most_warm);
    check_note("calls to the end, most", most_calls);
    CHECK(most_points <= POINTS_MOST);
    CHECK(most_sized <= WORK_MOST);
    CHECK(most_calls < 40U);
}

/// A support that still holds costs one pass.
static void warm_is_one_pass(void) {
    make_set(CAP, 1, 0);
    struct follow_input input = {.centre_q30 = centre, .count = COUNT};
    struct follow_result result;
    CHECK_EQ(call(&input, &result), FOLLOW_OK);
    CHECK(result.work > 2U * COUNT);
    for (uint32_t i = 0; i < COUNT; i++) { // all move alike by a tenth of a degree
        centre[i] = vec3_normalise(vec3(centre[i].x + 2000000, centre[i].y, centre[i].z));
    }
    CHECK_EQ(call(&input, &result), FOLLOW_OK);
    check_note("work", result.work);
    CHECK(result.work < 700U + COUNT + 10U);
}

/// Targets that move at every tick, with a limit: the cone always holds all, and when they come to
/// rest it is the narrowest soon after.
static void moving(void) {
    struct follow_input input = {
        .centre_q30 = centre, .radius = radius, .count = COUNT, .work_limit = LIMIT};
    struct follow_result result;
    uint32_t unfinished = 0;
    for (uint32_t tick = 0; tick < 400U && check_clean(); tick++) {
        for (uint32_t i = 0; i < COUNT; i++) {
            const uint32_t rate = (i % 7U + 1U) << 16;
            centre[i] = polar(i * UINT32_C(0x9E3779B9) + tick * rate, (i + tick) % COUNT << 19);
            set_radius(i, i % 3U << 22);
        }
        const enum follow_status status = call(&input, &result);
        unfinished += status == FOLLOW_UNFINISHED;
        CHECK(status == FOLLOW_OK || status == FOLLOW_UNFINISHED);
        CHECK(result.half_angle.bam == BAM32_HALF || holds_all(&input, &result));
        CHECK(result.work <= WORK_MOST);
    }
    check_note("ticks of 400 that had to go on", unfinished);
    uint32_t calls = 0;
    while (call(&input, &result) == FOLLOW_UNFINISHED && calls < 100U) {
        calls++;
    }
    struct follow_result at_once;
    const struct follow_input cold = {.centre_q30 = centre, .radius = radius, .count = COUNT};
    CHECK_EQ(follow_narrowest(&cold, &at_once), FOLLOW_OK);
    CHECK_NEAR(result.half_angle.bam, at_once.half_angle.bam, 14);
    CHECK(calls < 20U);
}

static void small_sets(void) {
    struct follow_input input = {.centre_q30 = centre, .count = 0};
    struct follow_result result;
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_EMPTY);
    input.count = 1;
    centre[0] = vec3(0, -Q30_ONE, 0);
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_OK);
    CHECK(vec3_equal(result.axis_q30, centre[0]));
    CHECK_EQ(result.half_angle.bam, 1);
    CHECK_EQ(result.support_count, 1);
    input.count = 2;
    centre[1] = vec3(0, Q30_ONE, 0);
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_INFEASIBLE);
    centre[1] = centre[0];
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_OK);
    CHECK_EQ(result.support_count, 1);
    // A cap inside another one, and one that is too wide for any picture.
    centre[1] = vec3_normalise(vec3(1, -10, 0));
    set_radius(0, BAM32_QUARTER / 2U);
    set_radius(1, 1000);
    input.radius = radius;
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_OK);
    CHECK(vec3_equal(result.axis_q30, centre[0]));
    CHECK_NEAR(result.half_angle.bam, BAM32_QUARTER / 2U, 8);
    set_radius(1, BAM32_QUARTER - 100U);
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_INFEASIBLE);
    // Only members count.
    const uint16_t member[] = {0};
    input.member = member;
    input.count = 1;
    CHECK_EQ(follow_narrowest(&input, &result), FOLLOW_OK);
    CHECK(vec3_equal(result.axis_q30, centre[0]));
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(work_is_bounded_and_ends);
    TEST(warm_is_one_pass);
    TEST(moving);
    TEST(small_sets);
    return check_finish();
}

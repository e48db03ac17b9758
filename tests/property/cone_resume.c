// The worst input that a search finds, and how a control loop gets through it: a bounded part in
// each call, resumed in the next. Work is reads of a point, an exact test counting as 16, as
// options.read_limit has it.

#include "check.h"
#include "property/support/cone_check.h"
#include "sphere/cone.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define POINTS_MAX 1000U
#define NO_LIMIT   UINT64_MAX
/// By how much a call may pass its limit, in reads a point: what cone.h promises.
#define OVERSHOOT 60U

static uint64_t random_state;
static uint64_t workspace[CONE_WORKSPACE_BYTES(POINTS_MAX) / 8U + 1U];

static double uniform(void) {
    return (double)(check_random(&random_state) >> 11) * 0x1p-53;
}

static struct vec3 at(double angle, double azimuth) {
    return vec3_normalise(vec3((int32_t)lround(sin(angle) * cos(azimuth) * 1e9),
                               (int32_t)lround(sin(angle) * sin(azimuth) * 1e9),
                               (int32_t)lround(cos(angle) * 1e9)));
}

static enum cone_status solve(const struct vec3 *points, uint32_t count, uint64_t limit,
                              const struct cone_result *before, struct cone_result *result) {
    const struct cone_options options = {.lengths = CONE_LENGTHS_UNIT,
                                         .workspace = workspace,
                                         .workspace_bytes = CONE_WORKSPACE_UNIT_BYTES(count),
                                         .warm = before->support,
                                         .warm_count = before->support_count,
                                         .read_limit = limit};
    return cone_narrowest(points, count, &options, result);
}

static uint64_t work_of(const struct vec3 *points, uint32_t count) {
    const struct cone_result cold = {0};
    struct cone_result result;
    CHECK_EQ(solve(points, count, NO_LIMIT, &cold, &result), CONE_OK);
    return result.point_reads;
}

/// A neighbour of the set: a point moves a little, or to another's mirror place, or two change
/// places.
static void mutate(struct vec3 *points, uint32_t count) {
    const uint32_t i = (uint32_t)(uniform() * count), j = (uint32_t)(uniform() * count);
    const struct vec3 kept = points[i];
    const double reach = pow(2.0, -30.0 * uniform());
    switch ((int)(uniform() * 4.0)) {
    case 0: // anywhere near
        points[i] =
            vec3_normalise(vec3(kept.x / 4 + (int32_t)lround((uniform() - 0.5) * reach * 0x1p28),
                                kept.y / 4 + (int32_t)lround((uniform() - 0.5) * reach * 0x1p28),
                                kept.z / 4 + (int32_t)lround((uniform() - 0.5) * reach * 0x1p28)));
        break;
    case 1: // one unit beside
        points[i].x ^= 1;
        break;
    case 2: // on the other side
        points[i] = vec3(-points[j].x, -points[j].y, points[j].z);
        break;
    default:
        points[i] = points[j];
        points[j] = kept;
        break;
    }
    if (points[i].z <= 0) {
        points[i] = kept;
    }
}

enum start { START_CAP, START_CIRCLE, START_SPIRAL, START_HALF_CIRCLE, STARTS };

static void begin(enum start start, struct vec3 *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const double part = (i + 1.0) / count;
        points[i] = start == START_CAP      ? at(0.5 * sqrt(uniform()), 2.0 * M_PI * uniform())
                    : start == START_CIRCLE ? at(0.5, 2.0 * M_PI * uniform())
                    : start == START_SPIRAL ? at(0.5 * part, 40.0 * part)
                                            : at(0.5, M_PI * part);
    }
}

/// Climbs from a set of the class to the worst that `steps` changes find.
static uint64_t climb(enum start class, struct vec3 *points, uint32_t count, unsigned steps) {
    static struct vec3 trial[POINTS_MAX];
    begin(class, points, count);
    uint64_t worst = work_of(points, count);
    for (unsigned step = 0; step < steps; step++) {
        memcpy(trial, points, count * sizeof *points);
        for (double more = 1.0; more > 0.4; more = uniform()) {
            mutate(trial, count);
        }
        const uint64_t work = work_of(trial, count);
        if (work >= worst) {
            worst = work;
            memcpy(points, trial, count * sizeof *points);
        }
    }
    return worst;
}

/// Solves in calls of `limit` reads. Returns how many it took.
static uint32_t solve_in_parts(const struct vec3 *points, uint32_t count, uint64_t limit) {
    const struct cone_result cold = {0};
    struct cone_result whole, part = {0};
    struct cone_report report;
    CHECK_EQ(solve(points, count, 0, &cold, &whole), CONE_OK);
    uint32_t calls = 0;
    for (enum cone_status status = CONE_UNFINISHED; status == CONE_UNFINISHED && calls < 400U;
         calls++) {
        struct cone_result next;
        status = solve(points, count, limit, &part, &next);
        CHECK(next.point_reads <= limit + (uint64_t)OVERSHOOT * count);
        CHECK(status == CONE_OK || status == CONE_UNFINISHED);
        part = next;
    }
    CHECK(vec3_equal(part.axis_q30, whole.axis_q30));
    CHECK(cone_check(points, count, CONE_OK, &part, &report) == NULL);
    return calls;
}

static void worst_sets_are_resumed(void) {
    const char *const names[STARTS] = {"cap", "circle", "spiral", "half circle"};
    const uint32_t sizes[] = {32, 256, POINTS_MAX};
    static struct vec3 points[POINTS_MAX];
    printf("# from         points   reads a point: begin, worst   calls of 2 reads a point\n");
    for (unsigned size = 0; size < 3U; size++) {
        const uint32_t count = sizes[size];
        for (int class = 0; class < STARTS; class ++) {
            begin((enum start) class, points, count);
            const double first = (double)work_of(points, count) / count;
            const uint64_t worst = climb((enum start) class, points, count, 200000U / count);
            const uint32_t calls = solve_in_parts(points, count, 2U * (uint64_t)count);
            printf("# %-12s %6u %20.1f %8.1f %10u\n", names[class], count, first,
                   (double)worst / count, calls);
            CHECK(calls < 400U);
        }
    }
}

/// Points that go on moving while the search goes on: it arrives within a few calls all the same.
static void moving_sets_are_followed(void) {
    static struct vec3 points[POINTS_MAX];
    const uint32_t count = 256;
    struct cone_result part = {0};
    uint32_t unfinished = 0;
    for (int tick = 0; tick < 500; tick++) {
        for (uint32_t i = 0; i < count; i++) {
            const double a = i * 2.399963, r = 0.3 + 0.1 * sin(0.01 * tick + i);
            points[i] = at(r, a + 0.001 * tick);
        }
        struct cone_result next;
        const enum cone_status status = solve(points, count, 2U * (uint64_t)count, &part, &next);
        CHECK(next.point_reads <= (2U + OVERSHOOT) * (uint64_t)count);
        unfinished += status == CONE_UNFINISHED ? 1U : 0U;
        part = next;
        struct cone_report report;
        CHECK(status == CONE_UNFINISHED ||
              cone_check(points, count, status, &next, &report) == NULL);
    }
    printf("# %u of 500 calls of 2 reads a point left unfinished\n", unfinished);
    CHECK(unfinished > 0U && unfinished < 250U);
}

int main(void) {
    random_state = 20261122;
    printf("# seed %llu\n", (unsigned long long)random_state);
    TEST(worst_sets_are_resumed);
    TEST(moving_sets_are_followed);
    cone_check_free();
    return check_finish();
}

/// Margins of viewpoints, and which targets line up.
#include "mcu/digest/sets.h"

#include "regular/lineup.h"
#include "regular/viewpoint.h"

#define COUNT_MAX 12U

static void fold_margin(struct digest *d, const struct viewpoint_margin *margin) {
    for (unsigned i = 0; i < 3U; i++) {
        digest_u64(d, margin->target[i]);
    }
    for (unsigned i = 0; i < 4U; i++) {
        digest_u64(d, margin->numerator.word[i]);
    }
    digest_i128(d, margin->denominator);
    digest_u64(d, margin->through);
}

static struct vec3 draw_place(struct digest *d, uint32_t range) {
    const int32_t x = digest_within(d, range);
    const int32_t y = digest_within(d, range);
    return vec3(x, y, digest_within(d, range));
}

static void margins(void) {
    struct digest d = digest_start(51);
    struct vec3 targets[COUNT_MAX];
    for (int i = 0; i < 60; i++) {
        const uint32_t range = i % 3 == 0 ? 3U : (uint32_t)VIEWPOINT_COORDINATE_MAX;
        const uint32_t count = digest_below(&d, COUNT_MAX + 1U);
        for (uint32_t t = 0; t < count; t++) {
            targets[t] = draw_place(&d, range);
        }
        const struct vec3 viewpoint = draw_place(&d, range);
        struct viewpoint_result result;
        digest_i64(&d, viewpoint_margins(targets, count, viewpoint, i % 4 != 0, &result));
        fold_margin(&d, &result.line);
        fold_margin(&d, &result.plane);
        digest_u64(&d, result.collinear);
        digest_u64(&d, result.bad[0]);
    }
    digest_finish(&d, "digest regular/viewpoint");
}

static void lineups(void) {
    struct digest d = digest_start(52);
    static uint64_t workspace[LINEUP_WORKSPACE_BYTES(COUNT_MAX) / sizeof(uint64_t) + 1U];
    struct vec3 directions[COUNT_MAX];
    for (int i = 0; i < 250; i++) {
        const uint32_t range = i % 3 == 0 ? 30000U : 1U + digest_below(&d, 4);
        const uint32_t count = digest_below(&d, COUNT_MAX + 1U);
        for (uint32_t t = 0; t < count; t++) {
            directions[t] = draw_place(&d, range);
        }
        struct lineup_result result;
        digest_i64(&d, lineup_find(directions, count, true, workspace, sizeof workspace, &result));
        digest_u64(&d, result.triples);
        digest_u64(&d, result.pairs);
        digest_u64(&d, result.turns);
        digest_vec3_i64(&d, result.normal);
        for (unsigned k = 0; k < 3U; k++) {
            digest_u64(&d, result.first[k]);
        }
    }
    digest_finish(&d, "digest regular/lineup");
}

int main(void) {
    TEST(margins);
    TEST(lineups);
    return check_finish();
}

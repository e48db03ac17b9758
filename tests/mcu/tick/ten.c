/// What the narrowest cone of ten points costs: 300 sets, uniform on a cap of 20 degrees, unit
/// vectors.
///
/// On an emulated processor it prints `cone 10 MEAN`, the instructions of cone_narrowest
/// (meter.h). On the host there is nothing to count with: callgrind does, from outside.
/// tests/gate/cone.sh.
#include "check.h"

#include "fixed/root.h"
#include "fixed/trig.h"
#include "sphere/cone.h"

#ifdef __arm__
#include "mcu/tick/meter.h"
#else
#include <stdio.h>
#endif

int main(void);

#define SETS   300U
#define POINTS 10U

/// 1 - cos 20 degrees, Q1.30.
#define CAP_HEIGHT_Q30 64753974U

static struct vec3 draw(uint64_t *random) {
    const uint64_t bits = check_random(random);
    const int64_t z = ((int64_t)1 << 30) - (int64_t)((bits >> 32) * CAP_HEIGHT_Q30 >> 32);
    const int64_t level = root_u64((UINT64_C(1) << 60) - (uint64_t)(z * z));
    const struct sincos azimuth = trig_sincos(bam32((uint32_t)bits));
    return vec3_normalise(vec3((int32_t)(level * azimuth.cos_q30 >> 30),
                               (int32_t)(level * azimuth.sin_q30 >> 30), (int32_t)z));
}

/// False: no answer.
static bool solve(const struct vec3 *points) {
    static uint64_t workspace[CONE_WORKSPACE_UNIT_BYTES(POINTS) / sizeof(uint64_t) + 1U];
    const struct cone_options options = {
        .lengths = CONE_LENGTHS_UNIT, .workspace = workspace, .workspace_bytes = sizeof workspace};
    struct cone_result result;
    return cone_narrowest(points, POINTS, &options, &result) == CONE_OK;
}

int main(void) {
    uint64_t random = 19650301;
    bool right = true;
#ifdef __arm__
    uint64_t sum = 0;
    right = meter_start();
#endif
    for (unsigned set = 0; set < SETS && right; set++) {
        struct vec3 points[POINTS];
        for (unsigned i = 0; i < POINTS; i++) {
            points[i] = draw(&random);
        }
#ifdef __arm__
        const uint32_t start = meter_now();
        right = solve(points);
        sum += meter_between(start, meter_now()) - meter_overhead;
#else
        right = solve(points);
#endif
    }
#ifdef __arm__
    meter_say(right ? "cone" : "error", "10", (uint32_t)(sum / SETS));
#else
    printf("%s %u sets\n", right ? "solved" : "error", SETS);
#endif
    return right ? 0 : 1;
}

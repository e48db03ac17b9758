/// The frame of random sets with radii and weights, against long double: it holds every framed
/// target's rim, and is at most 9 BAM wider than the widest asks for.
#include "check.h"

#include "aim/framing.h"

#include <math.h>

static const long double bam_per_radian = 4294967296.0L / 6.283185307179586476925286766559005768L;
static uint64_t seed = UINT64_C(0x5EED0002);
static struct target_set set;
static struct framing_workspace workspace;

static long double angle_bam(struct vec3 a, struct vec3 b) {
    const long double x = (long double)a.y * b.z - (long double)a.z * b.y,
                      y = (long double)a.z * b.x - (long double)a.x * b.z,
                      z = (long double)a.x * b.y - (long double)a.y * b.x;
    const long double dot =
        (long double)a.x * b.x + (long double)a.y * b.y + (long double)a.z * b.z;
    return atan2l(sqrtl(x * x + y * y + z * z), dot) * bam_per_radian;
}

/// One draw a statement, here and below: the order within an expression is the compiler's choice.
static struct vec3 any_vec3(unsigned shift) {
    const int32_t x = (int32_t)check_random(&seed);
    const int32_t y = (int32_t)check_random(&seed);
    const int32_t z = (int32_t)check_random(&seed);
    return vec3(x >> shift, y >> shift, z >> shift);
}

/// Targets within a random spread round a random direction; radii from nothing to the largest.
static void make_set(void) {
    target_set_init(&set, (struct vec3_i64){0, 0, 0}, 0);
    const uint32_t count = 1U + (uint32_t)(check_random(&seed) % 12U);
    const unsigned spread = (unsigned)(check_random(&seed) % 30U),
                   radius_shift = (unsigned)(check_random(&seed) % 33U);
    const struct vec3 centre = any_vec3(1);
    for (uint32_t id = 0; id < count; id++) {
        const uint64_t radius = (check_random(&seed) >> 34) >> radius_shift;
        const uint32_t weight = (uint32_t)check_random(&seed);
        const struct vec3 off = any_vec3(1U + spread);
        const struct target_update update = {
            .kind = TARGET_DIRECTION,
            .id = id,
            .weight_q16 = weight % 4U == 0U ? 0U : weight,
            .direction = {centre.x + off.x, centre.y + off.y, centre.z + off.z},
            .radius_bam32 = (uint32_t)radius};
        CHECK_EQ(target_set_apply(&set, &update, 0), TARGET_OK);
    }
}

static void frames_hold_every_rim(void) {
    check_note("seed", (int64_t)seed);
    long double most = 0.0L;
    int64_t solved = 0;
    for (int i = 0; i < 200000 && check_clean(); i++) {
        make_set();
        struct framing framing;
        if (framing_solve(&set, &workspace, &framing) != FRAMING_OK) {
            continue;
        }
        long double widest = 0.0L;
        uint32_t framed = 0;
        for (uint32_t k = 0; k < set.count; k++) {
            if (set.target[k].weight_q16 != 0U) {
                framed++;
                widest = fmaxl(widest, angle_bam(framing.ahead_q30, set.direction_q30[k]) +
                                           (long double)set.target[k].radius_bam32);
            }
        }
        const long double got = framing.half_angle_bam32.bam;
        CHECK_EQ(framing.framed_count, framed);
        if (framing.half_angle_bam32.bam == BAM32_HALF) { // no picture holds the rims
            CHECK(widest > 1073741824.0L - 700.0L);
            continue;
        }
        CHECK(got >= widest);
        CHECK(got <= widest + 9.0L);
        most = fmaxl(most, got - widest);
        solved++;
    }
    check_note("sets solved", solved);
    check_note("excess in 1/1000 BAM, most", (int64_t)(most * 1000.0L));
    CHECK(solved > 50000);
}

int main(void) {
    TEST(frames_hold_every_rim);
    return check_finish();
}

/// Direction and angular radius of spheres, as target_set works them out, against long double.
#include "check.h"

#include "target/target_set.h"

#include <math.h>

__extension__ typedef __int128 int128;

static const long double bam_per_radian = 4294967296.0L / 6.283185307179586476925286766559005768L;
static uint64_t seed = UINT64_C(0x5EED0001);
static struct target_set set;

/// Up to 2^52 in size; every size comes up.
static int64_t any_coordinate(void) {
    const unsigned shift = 12U + (unsigned)(check_random(&seed) % 52U);
    const int64_t size = (int64_t)(check_random(&seed) >> shift);
    return (check_random(&seed) & 1U) != 0U ? size : -size;
}

/// One draw a statement: the order within an expression is the compiler's choice.
static struct vec3_i64 any_position(void) {
    const int64_t x = any_coordinate();
    const int64_t y = any_coordinate();
    const int64_t z = any_coordinate();
    return (struct vec3_i64){x, y, z};
}

struct excess {
    long double least_bam, most_bam;
};

/// Puts one sphere into the set. False if it holds the viewpoint (and the set agrees).
static bool see(struct vec3_i64 viewpoint, struct vec3_i64 position, uint32_t radius,
                struct excess *excess) {
    target_set_init(&set, viewpoint, 0);
    const struct target_update update = {
        .kind = TARGET_POSITION, .id = 1, .position_um = position, .radius_um = radius};
    const enum target_status status = target_set_apply(&set, &update, 0);
    const int128 x = position.x - viewpoint.x, y = position.y - viewpoint.y,
                 z = position.z - viewpoint.z;
    const int128 tangent2 = x * x + y * y + z * z - (int128)radius * radius;
    if (tangent2 <= 0) {
        CHECK_EQ(status, TARGET_ERROR_VIEWPOINT);
        return false;
    }
    CHECK_EQ(status, TARGET_OK);
    const long double length = sqrtl((long double)(x * x + y * y + z * z));
    const long double one = (long double)Q30_ONE;
    const long double dx = (long double)set.direction_q30[0].x - (long double)x / length * one,
                      dy = (long double)set.direction_q30[0].y - (long double)y / length * one,
                      dz = (long double)set.direction_q30[0].z - (long double)z / length * one;
    CHECK(fabsl(dx) < 0.501L && fabsl(dy) < 0.501L && fabsl(dz) < 0.501L);
    // The tangent was rounded down to a whole number: that much is allowed, and 2 BAM.
    const long double tangent = sqrtl((long double)tangent2);
    const long double exact = atan2l(radius, tangent) * bam_per_radian;
    const long double widest = atan2l(radius, floorl(tangent)) * bam_per_radian;
    const long double got = set.target[0].radius_bam32;
    CHECK(radius == 0U ? got == 0.0L : got >= exact);
    CHECK(got <= widest + 2.0L);
    excess->least_bam = radius == 0U ? excess->least_bam : fminl(excess->least_bam, got - exact);
    excess->most_bam = fmaxl(excess->most_bam, got - widest);
    return check_clean();
}

static void spheres_are_never_seen_too_small(void) {
    check_note("seed", (int64_t)seed);
    struct excess excess = {1.0e9L, -1.0e9L};
    int64_t seen = 0;
    for (int i = 0; i < 300000 && check_clean(); i++) {
        const struct vec3_i64 viewpoint = any_position();
        const struct vec3_i64 position = any_position();
        const unsigned shift = (unsigned)(check_random(&seed) % 32U);
        const uint32_t radius = (uint32_t)check_random(&seed) >> shift;
        seen += see(viewpoint, position, radius, &excess);
    }
    check_note("spheres seen", seen);
    check_note("excess in 1/1000 BAM, least", (int64_t)(excess.least_bam * 1000.0L));
    check_note("excess in 1/1000 BAM, most", (int64_t)(excess.most_bam * 1000.0L));
}

/// The viewpoint within a few micrometres of the surface, at every distance.
static void grazing_spheres(void) {
    check_note("seed", (int64_t)seed);
    struct excess excess = {1.0e9L, -1.0e9L};
    int64_t seen = 0;
    for (int i = 0; i < 300000 && check_clean(); i++) {
        const unsigned shift = 34U + (unsigned)(check_random(&seed) % 29U);
        const int64_t x = (int64_t)(check_random(&seed) >> shift),
                      y = (int64_t)(check_random(&seed) >> shift);
        const long double distance = sqrtl((long double)x * x + (long double)y * y);
        const long double radius =
            floorl(distance) + (long double)(check_random(&seed) % 5U) - 2.0L;
        if (radius < 0.0L) {
            continue;
        }
        const struct vec3_i64 origin = {0, 0, 0}, position = {0, x, -y};
        seen += see(origin, position, (uint32_t)radius, &excess);
    }
    check_note("spheres seen", seen);
    CHECK(seen > 100000);
}

int main(void) {
    TEST(spheres_are_never_seen_too_small);
    TEST(grazing_spheres);
    return check_finish();
}

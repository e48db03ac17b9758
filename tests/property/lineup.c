/// lineup_find against all triples, and what becomes of its answer without the turn. ROUNDS=N,
/// SEED=N.
#include "check.h"

#include "regular/lineup.h"
#include "regular/rotation.h"
#include "regular/viewpoint.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

__extension__ typedef __int128 wide;

#define SMALL_MAX 40U
#define LARGE     2000U

static uint64_t seed = 4321;
static unsigned long rounds = 600;
static uint64_t workspace[LINEUP_WORKSPACE_BYTES(LARGE) / sizeof(uint64_t) + 1U];

static bool is_coplanar(struct vec3 a, struct vec3 b, struct vec3 c) {
    return (wide)a.x * ((wide)b.y * c.z - (wide)b.z * c.y) +
               (wide)a.y * ((wide)b.z * c.x - (wide)b.x * c.z) +
               (wide)a.z * ((wide)b.x * c.y - (wide)b.y * c.x) ==
           0;
}

static struct lineup_result all_triples(const struct vec3 *d, uint32_t count) {
    struct lineup_result r = {0};
    for (uint32_t i = 0; i < count; i++) {
        for (uint32_t j = i + 1U; j < count; j++) {
            r.pairs += (wide)d[i].x * d[j].y == (wide)d[i].y * d[j].x &&
                       (wide)d[i].y * d[j].z == (wide)d[i].z * d[j].y &&
                       (wide)d[i].z * d[j].x == (wide)d[i].x * d[j].z;
            for (uint32_t k = j + 1U; k < count; k++) {
                if (is_coplanar(d[i], d[j], d[k]) && r.triples++ == 0U) {
                    r.first[0] = i;
                    r.first[1] = j;
                    r.first[2] = k;
                }
            }
        }
    }
    return r;
}

/// By its common divisor, the first component that is not 0 above 0.
static struct vec3 primitive_of(struct vec3 a) {
    int64_t x = llabs(a.x), y = llabs(a.y), z = llabs(a.z), sign = 1;
    while (x != 0 && y != 0) {
        x > y ? (x %= y) : (y %= x);
    }
    x += y;
    while (x != 0 && z != 0) {
        x > z ? (x %= z) : (z %= x);
    }
    if (a.x < 0 || (a.x == 0 && (a.y < 0 || (a.y == 0 && a.z < 0)))) {
        sign = -1;
    }
    const int64_t divisor = sign * (x + z);
    return vec3((int32_t)(a.x / divisor), (int32_t)(a.y / divisor), (int32_t)(a.z / divisor));
}

/// The normal of the first triple, from the directions as given; zero if all three are parallel.
static bool is_normal(const struct lineup_result *r, const struct vec3 *d) {
    struct vec3_i64 n = {0, 0, 0};
    for (int k = 0; k < 3 && r->triples != 0U && (n.x | n.y | n.z) == 0; k++) {
        const struct vec3 a = primitive_of(d[r->first[k == 2]]),
                          b = primitive_of(d[r->first[k == 0 ? 1 : 2]]);
        n = (struct vec3_i64){(int64_t)a.y * b.z - (int64_t)a.z * b.y,
                              (int64_t)a.z * b.x - (int64_t)a.x * b.z,
                              (int64_t)a.x * b.y - (int64_t)a.y * b.x};
    }
    return r->normal.x == n.x && r->normal.y == n.y && r->normal.z == n.z;
}

static bool same(const struct lineup_result *a, const struct lineup_result *b) {
    return a->triples == b->triples && a->pairs == b->pairs &&
           memcmp(a->first, b->first, sizeof a->first) == 0;
}

static struct lineup_result find(const struct vec3 *d, uint32_t count, bool turn) {
    struct lineup_result r;
    CHECK_EQ(lineup_find(d, count, turn, workspace, sizeof workspace, &r), LINEUP_OK);
    return r;
}

static int32_t draw(uint32_t range) {
    return (int32_t)(check_random(&seed) % (2U * range + 1U)) - (int32_t)range;
}

static uint32_t draw_set(struct vec3 *d, unsigned long round) {
    static const uint32_t ranges[] = {1, 2, 4, 30, 5000, 1 << 24};
    const uint32_t range = ranges[round % 6U];
    const uint32_t count = (uint32_t)(check_random(&seed) % (SMALL_MAX + 1U));
    for (uint32_t i = 0; i < count; i++) {
        do {
            d[i].x = draw(range);
            d[i].y = draw(range);
            d[i].z = draw(range);
        } while (vec3_is_zero(d[i]));
    }
    return count;
}

static void random_sets(void) {
    uint32_t turns = 0;
    for (unsigned long round = 0; round < rounds && check_clean(); round++) {
        const uint64_t before = seed;
        struct vec3 d[SMALL_MAX];
        const uint32_t count = draw_set(d, round);
        const struct lineup_result wanted = all_triples(d, count), got = find(d, count, true);
        turns = got.turns > turns ? got.turns : turns;
        CHECK(is_normal(&got, d));
        if (!CHECK(same(&got, &wanted))) {
            printf("  %u directions: %llu triples, not %llu, SEED=%llu\n", count,
                   (unsigned long long)got.triples, (unsigned long long)wanted.triples,
                   (unsigned long long)before);
        }
    }
    check_note("most turns tried", turns);
}

/// All places of a cube lattice but the middle, as seen from there: nearly everything lines up, and
/// most pairs have the same x.
static uint32_t lattice(struct vec3 *d, int32_t size) {
    uint32_t count = 0;
    for (int32_t x = -size; x <= size; x++) {
        for (int32_t y = -size; y <= size; y++) {
            for (int32_t z = -size; z <= size; z++) {
                if (x != 0 || y != 0 || z != 0) {
                    d[count++] = vec3(x, y, z);
                }
            }
        }
    }
    return count;
}

static void on_a_lattice_only_the_turn_is_right(void) {
    static struct vec3 d[LARGE];
    for (int32_t size = 1; size <= 3; size++) {
        const uint32_t count = lattice(d, size);
        const struct lineup_result wanted = all_triples(d, count), turned = find(d, count, true),
                                   as_is = find(d, count, false);
        CHECK(same(&turned, &wanted));
        CHECK(turned.turns > 0U);
        CHECK(is_normal(&turned, d));
        CHECK(as_is.triples != wanted.triples);
        printf("# lattice of %u: %llu triples, %llu without the turn, turn %u\n", count,
               (unsigned long long)wanted.triples, (unsigned long long)as_is.triples, turned.turns);
    }
    // However far apart its places are.
    const uint32_t count = lattice(d, 3);
    const struct lineup_result near = find(d, count, true);
    for (uint32_t i = 0; i < count; i++) {
        d[i] = vec3(d[i].x * 5000000, d[i].y * 5000000, d[i].z * 5000000);
    }
    const struct lineup_result far = find(d, count, true);
    CHECK(same(&near, &far));
    // Where nothing is vertical it needs none.
    const struct vec3 general[] = {{1, 0, 9}, {2, 5, 9}, {3, 1, 9}, {5, 2, 9}, {7, 3, 9}};
    const struct lineup_result wanted = all_triples(general, 5), as_is = find(general, 5, false);
    CHECK(same(&as_is, &wanted) && wanted.triples == 4U);
    CHECK_EQ(find(general, 5, true).turns, 0);
}

/// As the planner's margins count them.
static void agrees_with_the_margins(void) {
    for (unsigned long round = 0; round < 50U; round++) {
        struct vec3 t[SMALL_MAX];
        uint32_t count = 0;
        for (unsigned i = 0; i < SMALL_MAX; i++) {
            t[count].x = draw(3);
            t[count].y = draw(3);
            t[count].z = draw(3);
            bool new = !vec3_is_zero(t[count]);
            for (uint32_t j = 0; j < count; j++) {
                new = new && !vec3_equal(t[j], t[count]);
            }
            count += new ? 1U : 0U;
        }
        struct viewpoint_result margins;
        CHECK_EQ(viewpoint_margins(t, count, vec3(0, 0, 0), true, &margins), VIEWPOINT_OK);
        const struct lineup_result got = find(t, count, true);
        CHECK_EQ(got.pairs, margins.line.through);
        // On one line in space they line up, too; the plane of the viewpoint and that line is none
        // of three targets.
        CHECK_EQ(got.triples, margins.plane.through + margins.collinear);
    }
}

static void turns_are_rotations(void) {
    for (uint32_t number = 0; number < 2000U && check_clean(); number++) {
        const struct rotation t = rotation_try(number);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                CHECK_EQ(vec3_dot_unit(t.row[i], t.row[j]),
                         i == j ? (int64_t)t.scale * t.scale : 0);
            }
        }
        CHECK_EQ(vec3_det_sign(t.row[0], t.row[1], t.row[2]), 1);
        CHECK(number == 0U || t.scale > 0);
        const int32_t most = INT32_MAX / t.scale;
        CHECK(rotation_fits(&t, vec3(most, 0, 0)));
        CHECK(!rotation_fits(&t, vec3(most, most, 0)));
    }
}

static void refused_and_large(void) {
    static struct vec3 d[LARGE];
    struct lineup_result r;
    const struct vec3 zero[] = {{1, 2, 3}, {0, 0, 0}};
    CHECK_EQ(lineup_find(zero, 2, true, workspace, sizeof workspace, &r), LINEUP_ERROR_ZERO_VECTOR);
    CHECK_EQ(r.first[0], 1);
    CHECK_EQ(lineup_find(zero, 1, true, workspace, LINEUP_WORKSPACE_BYTES(1) - 1U, &r),
             LINEUP_ERROR_WORKSPACE);
    const struct vec3 long_one[] = {{INT32_MAX, INT32_MAX, 1}};
    CHECK_EQ(lineup_find(long_one, 1, true, workspace, sizeof workspace, &r),
             LINEUP_ERROR_POSITION);
    for (uint32_t i = 0; i < LARGE; i++) {
        d[i].x = draw(1 << 23);
        d[i].y = draw(1 << 23);
        d[i].z = 1 << 23;
    }
    const clock_t start = clock();
    r = find(d, LARGE, true);
    printf("# %u directions: %.2f s, %llu triples\n", LARGE,
           (double)(clock() - start) / CLOCKS_PER_SEC, (unsigned long long)r.triples);
}

int main(void) {
    seed = getenv("SEED") != NULL ? strtoull(getenv("SEED"), NULL, 10) : seed;
    rounds = getenv("ROUNDS") != NULL ? strtoul(getenv("ROUNDS"), NULL, 10) : rounds;
    check_note("seed", (int64_t)seed);
    TEST(random_sets);
    TEST(on_a_lattice_only_the_turn_is_right);
    TEST(agrees_with_the_margins);
    TEST(turns_are_rotations);
    TEST(refused_and_large);
    return check_finish();
}

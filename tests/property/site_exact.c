/// The tests of sphere/site.h against reals of 1,200 bits, on random directions and on planted
/// coincidences: points exactly on one circle, on one great circle, in right angles, at equal
/// distances, and one unit beside. COUNT=N sets, SEED=N.
#include "check.h"
#include "property/support/cone_sets.h"
#include "property/support/exact.h"
#include "property/support/exact_roots.h"

#include "fixed/root_sum.h"
#include "sphere/site_axis.h"

#include <stdio.h>
#include <stdlib.h>

static uint64_t seed;
static unsigned long set_count = 60000UL, zeros, signs;

static uint32_t below(uint32_t limit) {
    return (uint32_t)((check_random(&seed) >> 32) * limit >> 32);
}

static bool same_sign(int got, int wanted, const struct vec3 *p) {
    zeros += wanted == 0;
    signs++;
    if (!CHECK_EQ(got, wanted)) {
        for (unsigned i = 0; i < 4U; i++) {
            printf("  %d %d %d\n", p[i].x, p[i].y, p[i].z);
        }
        return false;
    }
    return true;
}

static bool near_by_one(struct vec3 got, struct vec3 wanted, const struct vec3 *p) {
    const bool right = CHECK_NEAR(got.x, wanted.x, 1) && CHECK_NEAR(got.y, wanted.y, 1) &&
                       CHECK_NEAR(got.z, wanted.z, 1);
    for (unsigned i = 0; !right && i < 3U; i++) {
        printf("  %d %d %d\n", p[i].x, p[i].y, p[i].z);
    }
    return right;
}

/// The axis of the circle through three, if they are different.
static bool check_axis(const struct vec3 *p, const struct site *s) {
    struct vec3 wanted;
    return !exact_circle_axis(p[0], p[1], p[2], &wanted) ||
           near_by_one(site_circle_axis(&s[0], &s[1], &s[2]), wanted, p);
}

static bool check_four(const struct vec3 *p) {
    struct site s[4];
    for (unsigned i = 0; i < 4U; i++) {
        s[i] = site_from(p[i]);
    }
    return check_axis(p, s) &&
           same_sign(site_plane_sign(&s[0], &s[1], &s[2], &s[3]),
                     exact_plane_sign(p[0], p[1], p[2], p[3]), p) &&
           same_sign(site_cap_sign(&s[0], &s[1], &s[2]), exact_cap_sign(p[0], p[1], p[2]), p) &&
           same_sign(site_distance_cmp(&s[0], &s[1], &s[2], &s[3]),
                     exact_distance_cmp(p[0], p[1], p[2], p[3]), p) &&
           same_sign(site_distance_cmp(&s[0], &s[1], &s[0], &s[3]),
                     exact_distance_cmp(p[0], p[1], p[0], p[3]), p);
}

static void random_sets(void) {
    for (unsigned long i = 0; i < set_count && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX], four[4];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        for (unsigned k = 0; k < 4U; k++) {
            four[k] = points[below(count)];
        }
        check_four(four);
    }
}

/// Permutations and signs of one vector lie on many common circles, at many equal distances.
static void coincidences(void) {
    for (unsigned long i = 0; i < set_count && check_clean(); i++) {
        const int32_t size = 1 << (1U + below(30));
        const int32_t v[3] = {(int32_t)below((uint32_t)size), (int32_t)below((uint32_t)size),
                              (int32_t)below((uint32_t)size) + 1};
        struct vec3 four[4];
        for (unsigned k = 0; k < 4U; k++) {
            const uint32_t turn = below(6), sign = below(8);
            const int32_t x = v[turn % 3U], y = v[(turn + 1U + turn / 3U) % 3U],
                          z = v[(turn + 2U - turn / 3U) % 3U];
            four[k] = vec3((sign & 1U) != 0U ? -x : x, (sign & 2U) != 0U ? -y : y,
                           (sign & 4U) != 0U ? -z : z);
        }
        if (below(4) == 0U) {
            struct vec3 *const beside = &four[below(4)];
            beside->x += beside->x == -1 ? 2 : 1;
        }
        check_four(four);
    }
}

/// sqrt(a^2 r) + sqrt(b^2 r) - sqrt((a + b)^2 r), and the like, are zero; with one unit more they
/// are not.
static void roots_that_cancel(void) {
    for (unsigned i = 0; i < 100000U && check_clean(); i++) {
        const uint64_t a = check_random(&seed) >> 3, b = check_random(&seed) >> 3,
                       c = check_random(&seed) >> 3;
        const struct u128 r = {check_random(&seed), 0}, other = {check_random(&seed), 0};
        const struct u128 sum = u128_add((struct u128){a, 0}, (struct u128){b, 0});
        const struct u128 more = u128_add(sum, (struct u128){1, 0});
        struct root_term ra, rb, rsum, rmore, rc, rminus;
        root_term_set(&ra, 1, (struct u128){a, 0}, r);
        root_term_set(&rb, 1, (struct u128){b, 0}, r);
        root_term_set(&rsum, -1, sum, r);
        root_term_set(&rmore, -1, more, r);
        root_term_set(&rc, 1, (struct u128){c, 0}, other);
        root_term_set(&rminus, -1, (struct u128){c, 0}, other);
        const int wanted = r.lo == 0U ? 0 : -1;
        CHECK_EQ(root_sum_3(&ra, &rb, &rsum), 0);
        CHECK_EQ(root_sum_3(&rb, &rmore, &ra), wanted);
        CHECK_EQ(root_sum_3(&rmore, &ra, &rb), wanted);
        CHECK_EQ(root_sum_4(&ra, &rb, &rsum, &rc), rc.sign);
        CHECK_EQ(root_sum_4(&ra, &rsum, &rminus, &rb), rminus.sign);
        CHECK_EQ(root_sum_2(&rc, &rminus), 0);
        CHECK_EQ(root_sum_4(&rc, &ra, &rminus, &rmore), root_sum_2(&ra, &rmore));
    }
}

static void middles(void) {
    for (unsigned long i = 0; i < set_count && check_clean(); i++) {
        struct vec3 points[CONE_SETS_SMALL_MAX];
        const uint32_t count = cone_sets_draw((enum cone_class)(i % CLASS_COUNT), &seed, points);
        const struct vec3 two[] = {points[0], points[below(count)], points[0]};
        if (!exact_parallel(two[0], two[1])) {
            const struct site a = site_from(two[0]), b = site_from(two[1]);
            struct vec3 wanted;
            CHECK(exact_middle(two[0], two[1], &wanted));
            near_by_one(site_middle(&a, &b), wanted, two);
        }
    }
}

/// Directions next to each other, or nearly opposite: where Q2.61 tells neither plane nor middle.
static void close_by(void) {
    for (unsigned long i = 0; i < set_count / 10U && check_clean(); i++) {
        struct vec3 four[4];
        const int32_t x = INT32_MAX - (int32_t)below(1000), y = (int32_t)below(1U << 31);
        for (unsigned k = 0; k < 4U; k++) {
            const int32_t sign = below(2) != 0U ? -1 : 1;
            four[k] = vec3(sign * (x - (int32_t)below(3)), sign * (y - (int32_t)below(3)),
                           sign * (y / 2 + (int32_t)below(3)));
        }
        check_four(four);
        if (!exact_parallel(four[0], four[1])) {
            const struct site a = site_from(four[0]), b = site_from(four[1]);
            struct vec3 wanted;
            CHECK(exact_middle(four[0], four[1], &wanted));
            near_by_one(site_middle(&a, &b), wanted, four);
        }
    }
}

int main(void) {
    const char *seed_text = getenv("SEED"), *count_text = getenv("COUNT");
    seed = seed_text != NULL ? strtoull(seed_text, NULL, 0) | 1U : 19851001U;
    set_count = count_text != NULL ? strtoul(count_text, NULL, 0) : set_count;
    printf("# seed %llu, %lu sets\n", (unsigned long long)seed, set_count);
    TEST(random_sets);
    TEST(coincidences);
    printf("# %lu signs, %lu of them zero\n", signs, zeros);
    CHECK(zeros * 20U > signs);
    TEST(middles);
    TEST(close_by);
    TEST(roots_that_cancel);
    exact_roots_free();
    exact_free();
    return check_finish();
}

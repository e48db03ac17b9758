/// Equation 18 against a search of the sphere: a grid of directions, and the best of it refined by
/// smaller and smaller steps.
#include "check.h"

#include "weigh.h"

#include <math.h>
#include <stdio.h>

#define OBJECTS_MOST 6

static uint64_t seed = UINT64_C(0x5EED0051);
static struct vec3 axis_q30[OBJECTS_MOST];
static double weights[OBJECTS_MOST];
static uint32_t count;

static double uniform(void) {
    return (double)(check_random(&seed) >> 11) * 0x1p-53;
}

static double cost_of(enum weigh_cost cost, double angle) {
    switch (cost) {
    case WEIGH_ONE_MINUS_COS:
        return 1 - cos(angle);
    case WEIGH_ANGLE_SQUARED:
        return angle * angle;
    default:
        return cos(angle) > 0 ? 1 / cos(angle) : HUGE_VAL;
    }
}

static double sum_at(enum weigh_cost cost, double x, double y, double z) {
    const double length = sqrt(x * x + y * y + z * z);
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        const double a = axis_q30[i].x * 0x1p-30, b = axis_q30[i].y * 0x1p-30,
                     c = axis_q30[i].z * 0x1p-30;
        const double u = y * c - z * b, v = z * a - x * c, w = x * b - y * a;
        const double angle =
            atan2(sqrt(u * u + v * v + w * w) / length, (x * a + y * b + z * c) / length);
        sum += weights[i] > 0 ? weights[i] * cost_of(cost, angle) : 0;
    }
    return sum;
}

static double search(enum weigh_cost cost) {
    double best = HUGE_VAL, at[3] = {0, 0, 1};
    for (int i = -20; i <= 20; i++) {
        for (int k = 0; k < 80; k++) {
            const double z = i / 20.0, level = sqrt(1 - z * z), turn = k * 6.283185307179586 / 80;
            const double found = sum_at(cost, level * cos(turn), level * sin(turn), z);
            if (found < best) {
                best = found;
                at[0] = level * cos(turn);
                at[1] = level * sin(turn);
                at[2] = z;
            }
        }
    }
    for (double step = 0.1; step > 1e-10;) {
        bool lower = false;
        for (int k = 0; k < 26 && !lower; k++) {
            const int code = k < 13 ? k : k + 1; // all but no step at all
            const double next[3] = {at[0] + step * (code % 3 - 1),
                                    at[1] + step * (code / 3 % 3 - 1),
                                    at[2] + step * (code / 9 - 1)};
            const double found = sum_at(cost, next[0], next[1], next[2]);
            if (found < best) {
                const double length =
                    sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
                best = found;
                lower = true;
                for (int m = 0; m < 3; m++) {
                    at[m] = next[m] / length;
                }
            }
        }
        step *= lower ? 1 : 0.6;
    }
    return best;
}

/// Objects anywhere (spread 1) or within part of the sphere.
static void make_objects(double spread) {
    count = 1U + (uint32_t)(check_random(&seed) % OBJECTS_MOST);
    const double x = uniform() - 0.5, y = uniform() - 0.5, z = uniform() - 0.5,
                 length = sqrt(x * x + y * y + z * z) + 1e-9;
    for (uint32_t i = 0; i < count; i++) {
        const double a = x / length + spread * (2 * uniform() - 1),
                     b = y / length + spread * (2 * uniform() - 1),
                     c = z / length + spread * (2 * uniform() - 1);
        axis_q30[i] =
            vec3_normalise(vec3((int32_t)lround(a * 0x1p27) + 1, (int32_t)lround(b * 0x1p27),
                                (int32_t)lround(c * 0x1p27)));
        weights[i] = check_random(&seed) % 5U == 0U ? 0 : uniform() * 3;
    }
    weights[0] += 0.1;
}

static void compare(enum weigh_cost cost, double spread, int sets) {
    int solved = 0;
    double worst = 0;
    for (int i = 0; i < sets && check_clean(); i++) {
        make_objects(spread);
        struct vec3 v;
        const enum weigh_status status =
            weigh_directions(axis_q30, weights, count, cost, vec3(0, 0, Q30_ONE), &v);
        const double want = search(cost);
        if (status == WEIGH_INFEASIBLE) {
            CHECK(cost == WEIGH_ONE_OVER_COS);
            CHECK(want > 50); // nothing but the very edge, if anything
            continue;
        }
        CHECK_EQ(status, WEIGH_OK);
        const double told = sum_at(cost, v.x, v.y, v.z);
        if (!CHECK(told <= want + 1e-9 * (1 + fabs(want)) || want > 1e5)) {
            printf("  # %u objects: told %.12g, found %.12g\n", count, told, want);
        }
        worst = fmax(worst, (told - want) / (1 + want));
        solved++;
    }
    check_note("sets", solved);
    check_note("cost above the search by parts in 10^12, most", (int64_t)(worst * 1e12));
    CHECK(solved > sets / 4);
}

static void one_minus_cos(void) {
    compare(WEIGH_ONE_MINUS_COS, 3, 400);
}

static void angle_squared(void) {
    compare(WEIGH_ANGLE_SQUARED, 0.8, 300);
}

static void angle_squared_on_the_whole_sphere(void) {
    compare(WEIGH_ANGLE_SQUARED, 4, 300);
}

static void one_over_cos(void) {
    compare(WEIGH_ONE_OVER_COS, 0.8, 400);
}

static void where_there_is_no_answer(void) {
    axis_q30[0] = vec3(Q30_ONE, 0, 0);
    axis_q30[1] = vec3(-Q30_ONE, 0, 0);
    weights[0] = weights[1] = 1;
    struct vec3 v = vec3(1, 2, 3);
    const struct vec3 near = vec3(0, Q30_ONE, 0);
    CHECK_EQ(weigh_directions(axis_q30, weights, 2, WEIGH_ONE_MINUS_COS, near, &v),
             WEIGH_UNDEFINED);
    CHECK(vec3_equal(v, vec3(1, 2, 3)));
    CHECK_EQ(weigh_directions(axis_q30, weights, 2, WEIGH_ONE_OVER_COS, near, &v),
             WEIGH_INFEASIBLE);
    weights[1] = 0.5;
    CHECK_EQ(weigh_directions(axis_q30, weights, 2, WEIGH_ONE_MINUS_COS, near, &v), WEIGH_OK);
    CHECK(vec3_equal(v, axis_q30[0]));
    weights[0] = weights[1] = 0;
    CHECK_EQ(weigh_directions(axis_q30, weights, 2, WEIGH_ANGLE_SQUARED, near, &v),
             WEIGH_UNDEFINED);
}

/// Two objects and even weights: with the angle squared the speed is constant.
static void constant_speed(void) {
    axis_q30[0] = vec3(Q30_ONE, 0, 0);
    axis_q30[1] = vec3(0, Q30_ONE, 0);
    for (int i = 0; i <= 10; i++) {
        weights[0] = 1 - i / 10.0;
        weights[1] = i / 10.0;
        struct vec3 v;
        CHECK_EQ(weigh_directions(axis_q30, weights, 2, WEIGH_ANGLE_SQUARED, axis_q30[0], &v),
                 WEIGH_OK);
        CHECK(fabs(atan2(v.y, v.x) - i * 0.15707963267948966) < 2e-9);
    }
}

int main(void) {
    check_note("seed", (int64_t)seed);
    TEST(one_minus_cos);
    TEST(angle_squared);
    TEST(angle_squared_on_the_whole_sphere);
    TEST(one_over_cos);
    TEST(where_there_is_no_answer);
    TEST(constant_speed);
    return check_finish();
}

/// Optima against brute force: every bisector and circumcentre of the forbidden directions and
/// circles, in long double; and the variants against each other.
#include "check.h"
#include "property/support/regular_check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { COUNT_MOST = 12, FORBIDDEN_MOST = 66, CANDIDATES_MOST = 1 << 20 };
static struct vec3 points[3 * COUNT_MOST];
static long double best_value;
static const long double turn_rad = 6.283185307179586476925286766559L;

struct real3 {
    long double x, y, z;
};

/// What is forbidden, as unit vectors.
static struct {
    bool circles;
    uint32_t count;
    struct real3 at[FORBIDDEN_MOST];
} forbidden;

static struct real3 candidates[CANDIDATES_MOST];
static long double values[CANDIDATES_MOST];
static uint32_t candidate_count;

static struct real3 cross(struct real3 a, struct real3 b) {
    return (struct real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static long double length(struct real3 a) {
    return sqrtl(a.x * a.x + a.y * a.y + a.z * a.z);
}

static struct real3 add(struct real3 a, long double by, struct real3 b) {
    return (struct real3){a.x + by * b.x, a.y + by * b.y, a.z + by * b.z};
}

static long double dot(struct real3 a, struct real3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The angle between two lines through 0, accurate at both ends.
static long double line_angle(struct real3 a, struct real3 b) {
    return atan2l(length(cross(a, b)), fabsl(dot(a, b)));
}

static long double value_of(struct real3 v) {
    long double least = turn_rad / 4;
    for (uint32_t i = 0; i < forbidden.count; i++) {
        const struct real3 f = forbidden.at[i];
        const long double here =
            forbidden.circles ? atan2l(fabsl(dot(v, f)), length(cross(v, f))) : line_angle(v, f);
        least = here < least ? here : least;
    }
    return least;
}

static void try(struct real3 v) {
    const long double size = length(v);
    if (size < 1e-9L || candidate_count == CANDIDATES_MOST) {
        return;
    }
    v = (struct real3){v.x / size, v.y / size, v.z / size};
    values[candidate_count] = value_of(v);
    best_value = fmaxl(best_value, values[candidate_count]);
    candidates[candidate_count++] = v;
}

static void forbid(int64_t x, int64_t y, int64_t z) {
    const struct real3 a = {(long double)x, (long double)y, (long double)z};
    const long double size = length(a);
    forbidden.at[forbidden.count++] = (struct real3){a.x / size, a.y / size, a.z / size};
}

static struct vec3_i64 normal_of(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3 u = {b.x - a.x, b.y - a.y, b.z - a.z}, v = {c.x - a.x, c.y - a.y, c.z - a.z};
    return vec3_cross(u, v);
}

static void forbid_plane(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i64 n = normal_of(a, b, c);
    forbid(n.x, n.y, n.z);
}

static bool collinear(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct vec3_i64 n = normal_of(a, b, c);
    return (n.x | n.y | n.z) == 0;
}

/// The plane of two segments, if they have one.
static void forbid_segments(const struct vec3 *a, const struct vec3 *b) {
    const struct vec3_i64 n =
        collinear(a[0], a[1], b[0]) ? normal_of(a[0], a[1], b[1]) : normal_of(a[0], a[1], b[0]);
    const struct vec3 d = {b[1].x - b[0].x, b[1].y - b[0].y, b[1].z - b[0].z};
    if (i128_sign(vec3_i64_dot_vec3(n, d)) == 0 || collinear(a[0], a[1], b[0])) {
        const struct vec3 to = {b[1].x - a[0].x, b[1].y - a[0].y, b[1].z - a[0].z};
        if (i128_sign(vec3_i64_dot_vec3(n, to)) == 0) {
            forbid(n.x, n.y, n.z);
        }
    }
}

static void list_forbidden(const struct regular_input *in) {
    const struct vec3 *const p = in->points;
    forbidden.count = 0;
    forbidden.circles = in->problem == REGULAR_POINTS3_X || in->problem == REGULAR_POINTS3_PLANE ||
                        in->problem == REGULAR_SEGMENTS3_PLANE ||
                        in->problem == REGULAR_FACES_VERTICAL;
    for (uint32_t i = 0; i < in->count; i++) {
        if (in->problem == REGULAR_FACES_VERTICAL) {
            forbid_plane(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
        } else if (in->problem == REGULAR_SEGMENTS2_VERTICAL ||
                   in->problem == REGULAR_SEGMENTS3_VERTICAL) {
            const struct vec3 a = p[2 * i], b = p[2 * i + 1];
            forbid((int64_t)b.x - a.x, (int64_t)b.y - a.y, (int64_t)b.z - a.z);
        }
        for (uint32_t j = i + 1; j < in->count; j++) {
            if (in->problem == REGULAR_SEGMENTS3_PLANE) {
                forbid_segments(p + 2 * i, p + 2 * j);
            } else if (in->problem <= REGULAR_POINTS3_X) {
                forbid((int64_t)p[j].x - p[i].x, (int64_t)p[j].y - p[i].y,
                       (int64_t)p[j].z - p[i].z);
            }
            for (uint32_t k = j + 1; in->problem == REGULAR_POINTS3_PLANE && k < in->count; k++) {
                forbid_plane(p[i], p[j], p[k]);
            }
        }
    }
}

/// Bisectors of two, centres of three, on every side of each.
static void try_all(bool planar) {
    candidate_count = 0;
    best_value = -1;
    for (uint32_t i = 0; i < forbidden.count; i++) {
        const struct real3 a = forbidden.at[i];
        try(planar ? (struct real3){-a.y, a.x, 0} : a);
        if (!planar && !forbidden.circles) {
            try((struct real3){-a.y, a.x, 0});
            try((struct real3){0, -a.z, a.y});
        }
        for (uint32_t j = i + 1; j < forbidden.count; j++) {
            for (int s = -1; s <= 1; s += 2) {
                const struct real3 b = add((struct real3){0, 0, 0}, s, forbidden.at[j]);
                try(add(a, 1, b));
                if (!planar) {
                    try(cross(a, b));
                }
                for (uint32_t k = j + 1; !planar && k < forbidden.count; k++) {
                    for (int t = -1; t <= 1; t += 2) {
                        const struct real3 c = add((struct real3){0, 0, 0}, t, forbidden.at[k]);
                        try(cross(add(b, -1, a), add(c, -1, a)));
                    }
                }
            }
        }
    }
}

static long double real_i128(struct i128 a) {
    return (long double)a.hi * 18446744073709551616.0L + (long double)a.lo;
}

static struct real3 direction_of(const struct regular_result *result) {
    return (struct real3){real_i128(result->direction.x), real_i128(result->direction.y),
                          real_i128(result->direction.z)};
}

static long double tolerance_of(const struct regular_result *result) {
    return (long double)result->tolerance_turn64 * turn_rad / 18446744073709551616.0L;
}

/// Is the direction within 2 nrad of a candidate that is as good as the best?
static bool near_an_optimum(struct real3 v) {
    for (uint32_t i = 0; i < candidate_count; i++) {
        if (values[i] > best_value - 1e-15L && line_angle(v, candidates[i]) < 2e-9L) {
            return true;
        }
    }
    // Where all of a circle is as good, any point of it will do: no line but one, or no circle.
    return value_of(v) > best_value - 1e-15L && best_value > turn_rad / 4 - 1e-15L;
}

static enum regular_status optimize(const struct regular_input *in,
                                    const struct regular_options *options,
                                    struct regular_result *result) {
    const uint64_t bytes =
        regular_workspace_bytes(in->problem, REGULAR_OPTIMIZE, in->count, options);
    void *const workspace = malloc(bytes + 1U);
    const enum regular_status status = regular_optimize(in, options, workspace, bytes, result);
    free(workspace);
    return status;
}

static bool check_optimum(const struct regular_input *in, const struct regular_options *options) {
    struct regular_result result;
    const enum regular_status status = optimize(in, options, &result);
    if (!check_exists(in)) {
        return CHECK_EQ(status, REGULAR_NONE) && CHECK(!result.regular) &&
               CHECK(check_conflict(in, &result.conflict));
    }
    if (!CHECK_EQ(status, REGULAR_OK)) {
        return false;
    }
    if (forbidden.count == 0U) {
        return CHECK_EQ(result.tolerance_turn64, UINT64_C(1) << 62);
    }
    const struct real3 v = direction_of(&result);
    const long double tolerance = tolerance_of(&result), here = value_of(v);
    const bool good = CHECK(tolerance <= here + 1e-18L) && CHECK(tolerance > here - 1e-12L) &&
                      CHECK(here > best_value - 1e-12L) && CHECK(here < best_value + 1e-12L) &&
                      CHECK(near_an_optimum(v)) && CHECK(!result.tolerance_is_bound);
    if (!good) {
        printf("  %s count %u: tolerance %.18Lg, there %.18Lg, best %.18Lg\n",
               check_problem_name(in->problem), in->count, tolerance, here, best_value);
    }
    return good;
}

static uint32_t most(enum regular_problem problem) {
    return problem == REGULAR_POINTS3_PLANE                                      ? 6U
           : regular_points_of(problem) == 1U && problem != REGULAR_POINTS2_LINE ? 7U
                                                                                 : COUNT_MOST;
}

/// Segments of a wire frame: each ends where an earlier one does, so that many share planes, and
/// none is alone.
static void join_segments(uint64_t *seed, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t to = (uint32_t)(check_random(seed) % (2U * i));
        if (!vec3_equal(points[to], points[2 * i + 1])) {
            points[2 * i] = points[to];
        }
    }
}

static bool draw(uint64_t *seed, enum regular_problem problem, struct regular_input *in) {
    const int32_t sizes[] = {1, 2, 4, 40, 5000, REGULAR_COORDINATE_MAX};
    const int32_t size = sizes[check_random(seed) % 6U];
    in->problem = problem;
    in->points = points;
    in->count = (uint32_t)(check_random(seed) % (most(problem) + 1U));
    if (!check_draw(seed, problem, in->count, size, points)) {
        return false;
    }
    if (problem == REGULAR_SEGMENTS3_PLANE) {
        in->count = in->count > 8U ? 8U : in->count == 1U ? 2U : in->count;
        if (in->count == 2U && !check_draw(seed, problem, 2, size, points)) {
            return false;
        }
        join_segments(seed, in->count);
    }
    return problem != REGULAR_POINTS3_PLANE || in->count != 2U;
}

static void optima_of(enum regular_problem problem, int rounds) {
    uint64_t seed = 111 + (uint64_t)problem;
    int64_t done = 0;
    for (int i = 0; i < rounds; i++) {
        struct regular_input in;
        if (!draw(&seed, problem, &in)) {
            continue;
        }
        list_forbidden(&in);
        try_all(regular_is_planar(problem));
        const struct regular_options other = {.buckets = true, .cylinder = true};
        if (!check_optimum(&in, NULL) || !check_optimum(&in, &other)) {
            check_note("round", i);
            return;
        }
        done++;
    }
    check_note(check_problem_name(problem), done);
}

static void gaps(void) {
    optima_of(REGULAR_POINTS2_LINE, 500);
    optima_of(REGULAR_SEGMENTS2_VERTICAL, 500);
}

/// Nearly even directions, whose widest gap is hardly wider than the mean one: buckets that were
/// a little too wide would swallow it.
static void even_gaps(void) {
    uint64_t seed = 131;
    for (int round = 0; round < 400; round++) {
        const uint32_t count = 2U + (uint32_t)(check_random(&seed) % (COUNT_MOST - 1U));
        const struct regular_input in = {REGULAR_SEGMENTS2_VERTICAL, points, count};
        const long double start = (long double)(check_random(&seed) % 1000U) / 100;
        for (uint32_t i = 0; i < count; i++) {
            const long double jitter = (long double)(check_random(&seed) % 1000U) / 20000;
            const long double angle = start + (i + jitter) * turn_rad / 2 / count;
            points[2 * i] = vec3(0, 0, 0);
            points[2 * i + 1] =
                vec3((int32_t)(1e6L * cosl(angle)), (int32_t)(1e6L * sinl(angle)), 0);
        }
        list_forbidden(&in);
        try_all(true);
        const struct regular_options buckets = {.buckets = true};
        if (!check_optimum(&in, NULL) || !check_optimum(&in, &buckets)) {
            check_note("round", round);
            return;
        }
    }
}

static void empty_circles(void) {
    optima_of(REGULAR_POINTS3_LINE, 60);
    optima_of(REGULAR_SEGMENTS3_VERTICAL, 150);
}

static void arrangements(void) {
    optima_of(REGULAR_POINTS3_X, 60);
    optima_of(REGULAR_POINTS3_PLANE, 80);
    optima_of(REGULAR_SEGMENTS3_PLANE, 100);
    optima_of(REGULAR_FACES_VERTICAL, 150);
}

// ---------------------------------------------------------------- lone segments

/// Directions of segments, beside the circles of those that share planes.
static struct {
    uint32_t count;
    struct real3 at[COUNT_MOST];
} own;

static long double mixed_value(struct real3 v) {
    long double least = value_of(v);
    for (uint32_t i = 0; i < own.count; i++) {
        least = fminl(least, line_angle(v, own.at[i]));
    }
    return least;
}

/// Is there no place in this square of a cube's face that is farther away than `most`? The value
/// changes by no more than the direction turns.
static bool nothing_beyond(int face, long double u, long double v, long double half,
                           long double most) {
    const struct real3 on_face = {u, v, 1};
    const struct real3 at = face == 0   ? on_face
                            : face == 1 ? (struct real3){v, 1, u}
                                        : (struct real3){1, u, v};
    const long double value = mixed_value(at);
    if (value > most) {
        return false;
    }
    if (value + 1.4143L * half <= most) {
        return true;
    }
    half /= 2;
    return nothing_beyond(face, u - half, v - half, half, most) &&
           nothing_beyond(face, u - half, v + half, half, most) &&
           nothing_beyond(face, u + half, v - half, half, most) &&
           nothing_beyond(face, u + half, v + half, half, most);
}

static bool check_mixed(const struct regular_input *in) {
    list_forbidden(in);
    own.count = 0;
    for (uint32_t i = 0; i < in->count; i++) {
        const struct vec3 *const s = &in->points[2 * i];
        const struct real3 d = {(long double)s[1].x - s[0].x, (long double)s[1].y - s[0].y,
                                (long double)s[1].z - s[0].z};
        own.at[own.count++] = d;
    }
    struct regular_result result;
    if (!CHECK_EQ(optimize(in, NULL, &result), REGULAR_OK)) {
        return false;
    }
    const long double tolerance = tolerance_of(&result);
    const long double there = mixed_value(direction_of(&result));
    bool good = CHECK(tolerance <= there + 1e-18L) && CHECK(tolerance > there - 1e-12L) &&
                CHECK(!result.tolerance_is_bound);
    for (int face = 0; face < 3 && good; face++) {
        good = CHECK(nothing_beyond(face, 0, 0, 1, there + 1e-5L));
    }
    if (!good) {
        printf("  segments %u, circles %u: tolerance %.15Lg, there %.15Lg\n", in->count,
               forbidden.count, tolerance, there);
    }
    return good;
}

/// A few segments of a wire frame, and a few that lie in a plane with no other one: these forbid
/// their own direction only. Compared with a search of the whole sphere.
static void lone_segments(void) {
    uint64_t seed = 141;
    for (int round = 0; round < 60; round++) {
        const uint32_t joined = (uint32_t)(check_random(&seed) % 5U);
        const uint32_t count = joined + 1U + (uint32_t)(check_random(&seed) % 4U);
        const struct regular_input in = {REGULAR_SEGMENTS3_PLANE, points, count};
        if (!check_draw(&seed, REGULAR_SEGMENTS3_PLANE, count, 50000, points)) {
            continue;
        }
        join_segments(&seed, joined);
        if (check_exists(&in) && !check_mixed(&in)) {
            check_note("round", round);
            return;
        }
    }
}

int main(void) {
    check_note("seed 111 + problem", 111);
    TEST(gaps);
    TEST(even_gaps);
    TEST(empty_circles);
    TEST(arrangements);
    TEST(lone_segments);
    return check_finish();
}

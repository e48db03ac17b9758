#include "property/support/regular_check.h"

#include "check.h"

void check_vector_init(struct check_vector *v) {
    mpz_inits(v->at[0], v->at[1], v->at[2], NULL);
}

void check_vector_clear(struct check_vector *v) {
    mpz_clears(v->at[0], v->at[1], v->at[2], NULL);
}

static void set_i128(mpz_t to, struct i128 from) {
    mpz_set_si(to, from.hi);
    mpz_mul_2exp(to, to, 64);
    mpz_add_ui(to, to, from.lo);
}

void check_vector_set(struct check_vector *v, struct vec3_i128 from) {
    set_i128(v->at[0], from.x);
    set_i128(v->at[1], from.y);
    set_i128(v->at[2], from.z);
}

void check_vector_set_small(struct check_vector *v, int64_t x, int64_t y, int64_t z) {
    mpz_set_si(v->at[0], x);
    mpz_set_si(v->at[1], y);
    mpz_set_si(v->at[2], z);
}

static void between(struct check_vector *to, struct vec3 a, struct vec3 b) {
    check_vector_set_small(to, (int64_t)b.x - a.x, (int64_t)b.y - a.y, (int64_t)b.z - a.z);
}

static void cross(struct check_vector *to, const struct check_vector *a,
                  const struct check_vector *b) {
    for (int i = 0; i < 3; i++) {
        mpz_mul(to->at[i], a->at[(i + 1) % 3], b->at[(i + 2) % 3]);
        mpz_submul(to->at[i], a->at[(i + 2) % 3], b->at[(i + 1) % 3]);
    }
}

static void dot(mpz_t to, const struct check_vector *a, const struct check_vector *b) {
    mpz_mul(to, a->at[0], b->at[0]);
    mpz_addmul(to, a->at[1], b->at[1]);
    mpz_addmul(to, a->at[2], b->at[2]);
}

static bool is_zero(const struct check_vector *a) {
    return mpz_sgn(a->at[0]) == 0 && mpz_sgn(a->at[1]) == 0 && mpz_sgn(a->at[2]) == 0;
}

/// Registers for the formulas below.
enum { A, B, C, N, REGISTERS };
struct registers {
    struct check_vector v[REGISTERS];
    mpz_t s, t, u, sum;
};

static void open_registers(struct registers *r) {
    for (int i = 0; i < REGISTERS; i++) {
        check_vector_init(&r->v[i]);
    }
    mpz_inits(r->s, r->t, r->u, r->sum, NULL);
}

static void close_registers(struct registers *r) {
    for (int i = 0; i < REGISTERS; i++) {
        check_vector_clear(&r->v[i]);
    }
    mpz_clears(r->s, r->t, r->u, r->sum, NULL);
}

/// Do two points fall on one in the projection along v?
static bool coincide(struct registers *r, const struct check_vector *v, struct vec3 a,
                     struct vec3 b) {
    between(&r->v[A], a, b);
    cross(&r->v[N], v, &r->v[A]);
    return is_zero(&r->v[N]);
}

static bool same_onto(struct registers *r, const struct check_vector *v, struct vec3 a,
                      struct vec3 b) {
    between(&r->v[A], a, b);
    dot(r->s, v, &r->v[A]);
    return mpz_sgn(r->s) == 0;
}

/// Do three points fall on one line?
static bool line_up(struct registers *r, const struct check_vector *v, struct vec3 a, struct vec3 b,
                    struct vec3 c) {
    between(&r->v[A], a, b);
    between(&r->v[B], a, c);
    cross(&r->v[N], &r->v[A], &r->v[B]);
    dot(r->s, v, &r->v[N]);
    return mpz_sgn(r->s) == 0;
}

/// sum += |projection of d|^2 |v|^2 times the area that e and f span in the projection.
static void add_lifted(struct registers *r, const struct check_vector *v,
                       const struct check_vector *d, const struct check_vector *e,
                       const struct check_vector *f) {
    dot(r->s, v, v);
    dot(r->t, d, d);
    mpz_mul(r->s, r->s, r->t);
    dot(r->t, v, d);
    mpz_submul(r->s, r->t, r->t);
    cross(&r->v[N], e, f);
    dot(r->t, v, &r->v[N]);
    mpz_addmul(r->sum, r->s, r->t);
}

/// Do four points fall on one circle? The in-circle determinant, and no line.
static bool on_circle(struct registers *r, const struct check_vector *v, const struct vec3 p[4]) {
    if (line_up(r, v, p[0], p[1], p[2]) && line_up(r, v, p[0], p[1], p[3]) &&
        line_up(r, v, p[0], p[2], p[3])) {
        return false;
    }
    between(&r->v[A], p[3], p[0]);
    between(&r->v[B], p[3], p[1]);
    between(&r->v[C], p[3], p[2]);
    mpz_set_ui(r->sum, 0);
    add_lifted(r, v, &r->v[A], &r->v[B], &r->v[C]);
    add_lifted(r, v, &r->v[B], &r->v[C], &r->v[A]);
    add_lifted(r, v, &r->v[C], &r->v[A], &r->v[B]);
    return mpz_sgn(r->sum) == 0;
}

/// Do two segments fall on one line?
static bool segments_line_up(struct registers *r, const struct check_vector *v,
                             const struct vec3 *a, const struct vec3 *b) {
    return line_up(r, v, a[0], a[1], b[0]) && line_up(r, v, a[0], a[1], b[1]) &&
           line_up(r, v, b[0], b[1], a[0]);
}

static bool pair_conflicts(struct registers *r, const struct regular_input *in,
                           const struct check_vector *v, uint32_t i, uint32_t j) {
    const struct vec3 *const p = in->points;
    switch (in->problem) {
    case REGULAR_POINTS3_X:
    case REGULAR_POINTS3_XY:
    case REGULAR_POINTS3_XYZ:
        return same_onto(r, v, p[i], p[j]);
    case REGULAR_SEGMENTS3_PLANE:
        return segments_line_up(r, v, p + 2 * i, p + 2 * j);
    case REGULAR_SEGMENTS2_VERTICAL:
    case REGULAR_SEGMENTS3_VERTICAL:
    case REGULAR_FACES_VERTICAL:
        return false;
    default:
        return coincide(r, v, p[i], p[j]);
    }
}

static bool item_conflicts(struct registers *r, const struct regular_input *in,
                           const struct check_vector *v, uint32_t i) {
    const struct vec3 *const p = in->points;
    return (regular_points_of(in->problem) == 2U && coincide(r, v, p[2 * i], p[2 * i + 1])) ||
           (regular_points_of(in->problem) == 3U &&
            line_up(r, v, p[3 * i], p[3 * i + 1], p[3 * i + 2]));
}

static bool larger_conflicts(struct registers *r, const struct regular_input *in,
                             const struct check_vector *v, uint32_t i, uint32_t j) {
    const struct vec3 *const p = in->points;
    for (uint32_t k = j + 1; k < in->count; k++) {
        if (in->problem == REGULAR_POINTS3_PLANE && line_up(r, v, p[i], p[j], p[k])) {
            return true;
        }
        for (uint32_t l = k + 1; in->problem == REGULAR_POINTS3_COCIRCULAR && l < in->count; l++) {
            const struct vec3 four[4] = {p[i], p[j], p[k], p[l]};
            if (on_circle(r, v, four)) {
                return true;
            }
        }
    }
    return false;
}

bool check_direction(const struct regular_input *in, const struct check_vector *v) {
    if (is_zero(v)) {
        return false;
    }
    struct registers r;
    open_registers(&r);
    bool good = true;
    for (uint32_t i = 0; i < in->count && good; i++) {
        good = !item_conflicts(&r, in, v, i);
        for (uint32_t j = i + 1; j < in->count && good; j++) {
            good = !pair_conflicts(&r, in, v, i, j) && !larger_conflicts(&r, in, v, i, j);
        }
    }
    close_registers(&r);
    return good;
}

static bool are_axes(const struct check_vector rows[3]) {
    struct registers r;
    open_registers(&r);
    bool good = true;
    dot(r.u, &rows[0], &rows[0]);
    for (int i = 0; i < 3; i++) {
        dot(r.s, &rows[i], &rows[i]);
        good = good && mpz_cmp(r.s, r.u) == 0 && mpz_sgn(r.s) > 0;
        dot(r.s, &rows[i], &rows[(i + 1) % 3]);
        good = good && mpz_sgn(r.s) == 0;
    }
    cross(&r.v[N], &rows[0], &rows[1]);
    dot(r.s, &r.v[N], &rows[2]);
    good = good && mpz_sgn(r.s) > 0;
    close_registers(&r);
    return good;
}

bool check_axes(const struct regular_input *in, const struct check_vector rows[3]) {
    return are_axes(rows) && check_direction(in, &rows[0]) && check_direction(in, &rows[1]) &&
           (in->problem == REGULAR_POINTS3_XY || check_direction(in, &rows[2]));
}

bool check_as_given(const struct regular_input *in) {
    struct check_vector rows[3];
    for (int i = 0; i < 3; i++) {
        check_vector_init(&rows[i]);
        check_vector_set_small(&rows[i], i == 0, i == 1, i == 2);
    }
    const bool axes = in->problem == REGULAR_POINTS3_XY || in->problem == REGULAR_POINTS3_XYZ;
    const int along = in->problem == REGULAR_POINTS3_X ? 0 : regular_is_planar(in->problem) ? 1 : 2;
    const bool good = axes ? check_axes(in, rows) : check_direction(in, &rows[along]);
    for (int i = 0; i < 3; i++) {
        check_vector_clear(&rows[i]);
    }
    return good;
}

bool check_conflict(const struct regular_input *in, const struct regular_conflict *conflict) {
    const uint32_t of = regular_points_of(in->problem);
    struct vec3 points[4 * 3];
    if (conflict->count < 1 || conflict->count > 4) {
        return false;
    }
    for (uint32_t i = 0; i < conflict->count; i++) {
        if (conflict->index[i] >= in->count ||
            (i > 0 && conflict->index[i] <= conflict->index[i - 1])) {
            return false;
        }
        for (uint32_t k = 0; k < of; k++) {
            points[of * i + k] = in->points[of * conflict->index[i] + k];
        }
    }
    const struct regular_input alone = {in->problem, points, conflict->count};
    return !check_as_given(&alone);
}

static bool on_one_line(struct vec3 a, struct vec3 b, struct vec3 c) {
    struct registers r;
    open_registers(&r);
    between(&r.v[A], a, b);
    between(&r.v[B], a, c);
    cross(&r.v[N], &r.v[A], &r.v[B]);
    const bool yes = is_zero(&r.v[N]);
    close_registers(&r);
    return yes;
}

bool check_exists(const struct regular_input *in) {
    const struct vec3 *const p = in->points;
    for (uint32_t i = 0; i < in->count; i++) {
        for (uint32_t j = i + 1; j < in->count; j++) {
            if (in->problem == REGULAR_SEGMENTS3_PLANE &&
                on_one_line(p[2 * i], p[2 * i + 1], p[2 * j]) &&
                on_one_line(p[2 * i], p[2 * i + 1], p[2 * j + 1])) {
                return false;
            }
            for (uint32_t k = j + 1; in->problem == REGULAR_POINTS3_PLANE && k < in->count; k++) {
                if (on_one_line(p[i], p[j], p[k])) {
                    return false;
                }
            }
        }
    }
    return true;
}

static int32_t within(uint64_t *seed, int32_t size) {
    return (int32_t)(check_random(seed) % (2U * (uint32_t)size + 1U)) - size;
}

static bool is_new(const struct regular_input *in, uint32_t i) {
    const struct vec3 *const p = in->points;
    const uint32_t of = regular_points_of(in->problem);
    for (uint32_t j = 0; of == 1 && j < i; j++) {
        if (vec3_equal(p[j], p[i])) {
            return false;
        }
    }
    return of == 1 || (of == 2 && !vec3_equal(p[2 * i], p[2 * i + 1])) ||
           (of == 3 && !on_one_line(p[3 * i], p[3 * i + 1], p[3 * i + 2]));
}

bool check_draw(uint64_t *seed, enum regular_problem problem, uint32_t count, int32_t size,
                struct vec3 *points) {
    const uint32_t of = regular_points_of(problem);
    const struct regular_input in = {problem, points, count};
    for (uint32_t i = 0; i < count; i++) {
        int draws = 0;
        do {
            for (uint32_t k = 0; k < of; k++) {
                struct vec3 *const at = &points[of * i + k];
                at->x = within(seed, size);
                at->y = within(seed, size);
                at->z = regular_is_planar(problem) ? 0 : within(seed, size);
            }
            if (++draws > 1000) {
                return false;
            }
        } while (!is_new(&in, i));
    }
    return true;
}

const char *check_problem_name(enum regular_problem problem) {
    static const char *const names[REGULAR_PROBLEMS] = {
        "points2-line",       "points3-line",    "points3-x",          "points3-xy",
        "points3-xyz",        "points3-plane",   "points3-cocircular", "segments2-vertical",
        "segments3-vertical", "segments3-plane", "faces-vertical"};
    return names[problem];
}

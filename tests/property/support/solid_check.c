#include "property/support/solid_check.h"

#include "check.h"

#include <gmp.h>
#include <stdlib.h>

__extension__ typedef __int128 wide;

struct v {
    wide x, y, z;
};

static struct v difference(struct vec3 a, struct vec3 b) {
    return (struct v){(wide)a.x - b.x, (wide)a.y - b.y, (wide)a.z - b.z};
}

static struct v cross(struct v a, struct v b) {
    return (struct v){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static wide dot(struct v a, struct v b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Twice the area of a triangle, and the height of a point above it: at most 102 bits.
static struct v normal_of(const struct vec3 *p, uint32_t a, uint32_t b, uint32_t c) {
    return cross(difference(p[b], p[a]), difference(p[c], p[a]));
}

static bool is_null(struct v a) {
    return a.x == 0 && a.y == 0 && a.z == 0;
}

static void set_wide(mpz_t out, wide value) {
    const bool negative = value < 0;
    const unsigned __int128 size = negative ? -(unsigned __int128)value : (unsigned __int128)value;
    mpz_set_ui(out, (unsigned long)(size >> 64));
    mpz_mul_2exp(out, out, 64);
    mpz_add_ui(out, out, (unsigned long)size);
    if (negative) {
        mpz_neg(out, out);
    }
}

/// Sign of a . (b x c) for vectors of any size that fits.
static int det_sign(struct v a, struct v b, struct v c) {
    const wide row[3][3] = {{a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}};
    mpz_t m[3][3], sum, product;
    mpz_inits(sum, product, (mpz_ptr)NULL);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            mpz_init(m[i][k]);
            set_wide(m[i][k], row[i][k]);
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int way = 1; way <= 2; way++) {
            mpz_mul(product, m[0][i], m[1][(i + way) % 3]);
            mpz_mul(product, product, m[2][(i + 2 * way) % 3]);
            (way == 1 ? mpz_add : mpz_sub)(sum, sum, product);
        }
    }
    const int sign = mpz_sgn(sum);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            mpz_clear(m[i][k]);
        }
    }
    mpz_clears(sum, product, (mpz_ptr)NULL);
    return sign;
}

/// Are the vertices different points of the set, each the first of its equals?
static const char *check_indices(const struct vec3 *p, uint32_t count, const uint32_t *vertices,
                                 uint32_t vertex_count) {
    for (uint32_t i = 0; i < vertex_count; i++) {
        if (vertices[i] >= count) {
            return "a vertex is no point";
        }
        for (uint32_t k = 0; k < vertices[i]; k++) {
            if (vec3_equal(p[k], p[vertices[i]])) {
                return "a vertex is not the first of equal points";
            }
        }
        for (uint32_t k = 0; k < i; k++) {
            if (vec3_equal(p[vertices[k]], p[vertices[i]])) {
                return "a vertex comes twice";
            }
        }
    }
    return NULL;
}

static int compare_edges(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

/// Does each edge occur once in each direction?
static bool is_closed(const struct solid_hull *hull) {
    const uint32_t count = 3U * hull->face_count;
    uint64_t *const edge = malloc(2U * count * sizeof *edge), *const back = edge + count;
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t a = hull->faces[i / 3U].vertex[i % 3U],
                       b = hull->faces[i / 3U].vertex[(i + 1U) % 3U];
        edge[i] = a << 32 | b;
        back[i] = b << 32 | a;
    }
    qsort(edge, count, sizeof *edge, compare_edges);
    qsort(back, count, sizeof *back, compare_edges);
    bool good = true;
    for (uint32_t i = 0; i < count; i++) {
        good = good && edge[i] == back[i] && (i == 0U || edge[i] != edge[i - 1U]);
    }
    free(edge);
    return good;
}

/// Are three normals among the faces at each vertex independent? And is each vertex in a face?
static bool all_are_corners(const struct vec3 *p, uint32_t count, const struct solid_hull *hull) {
    struct corner {
        struct v normal[2];
        int rank;
    } *const corner = calloc(count, sizeof *corner);
    for (uint32_t i = 0; i < 3U * hull->face_count; i++) {
        const uint32_t *const v = hull->faces[i / 3U].vertex;
        struct corner *const c = &corner[v[i % 3U]];
        const struct v n = normal_of(p, v[0], v[1], v[2]);
        // The cross product of two normals can be too long for 128 bits: by determinants with axes.
        const struct v axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        bool grows = c->rank == 0;
        for (int k = 0; k < 3 && c->rank == 1; k++) {
            grows = grows || det_sign(axis[k], c->normal[0], n) != 0;
        }
        if (c->rank == 2) {
            grows = det_sign(c->normal[0], c->normal[1], n) != 0;
        }
        if (grows && c->rank < 3) {
            if (c->rank < 2) {
                c->normal[c->rank] = n;
            }
            c->rank++;
        }
    }
    uint32_t corners = 0;
    bool good = true;
    for (uint32_t i = 0; i < count; i++) {
        corners += corner[i].rank != 0 ? 1U : 0U;
        good = good && (corner[i].rank == 0 || corner[i].rank == 3);
    }
    for (uint32_t i = 0; i < hull->vertex_count; i++) {
        good = good && corner[hull->vertices[i]].rank == 3 &&
               (i == 0U || hull->vertices[i] > hull->vertices[i - 1U]);
    }
    free(corner);
    return good && corners == hull->vertex_count;
}

static const char *check_solid(const struct vec3 *p, uint32_t count,
                               const struct solid_hull *hull) {
    if (hull->vertex_count < 4U || hull->face_count != 2U * hull->vertex_count - 4U) {
        return "the numbers of faces and vertices do not go together";
    }
    for (uint32_t f = 0; f < hull->face_count; f++) {
        const uint32_t *const v = hull->faces[f].vertex;
        if (v[0] >= count || v[1] >= count || v[2] >= count || v[0] >= v[1] || v[0] >= v[2]) {
            return "a face does not start at its smallest index";
        }
        const struct v n = normal_of(p, v[0], v[1], v[2]);
        if (is_null(n)) {
            return "a face has no size";
        }
        for (uint32_t i = 0; i < count; i++) {
            if (dot(n, difference(p[i], p[v[0]])) > 0) {
                return "a point is above a face";
            }
        }
    }
    if (!is_closed(hull)) {
        return "the faces do not close";
    }
    return all_are_corners(p, count, hull) ? NULL : "a vertex is no corner, or a corner no vertex";
}

static const char *check_flat(const struct vec3 *p, uint32_t count, const struct solid_hull *hull) {
    const uint32_t *const v = hull->vertices, n = hull->vertex_count;
    if (n < 3U || hull->face_count != 0U) {
        return "a polygon has three corners or more, and no faces";
    }
    const struct v up = normal_of(p, v[0], v[1], v[2]);
    const wide last = up.z != 0 ? up.z : up.y != 0 ? up.y : up.x;
    if (last <= 0) {
        return "the polygon turns the wrong way, or has no size";
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t a = v[i], b = v[(i + 1U) % n], c = v[(i + 2U) % n];
        if (i != 0U && a < v[0]) {
            return "the polygon does not start at its smallest index";
        }
        const struct v side = difference(p[b], p[a]);
        if (det_sign(up, side, difference(p[c], p[a])) <= 0) {
            return "a corner of the polygon is none";
        }
        for (uint32_t k = 0; k < count; k++) {
            if (dot(up, difference(p[k], p[a])) != 0) {
                return "the set is not flat";
            }
            if (det_sign(up, side, difference(p[k], p[a])) < 0) {
                return "a point is outside the polygon";
            }
        }
    }
    return NULL;
}

static const char *check_line(const struct vec3 *p, uint32_t count, const struct solid_hull *hull) {
    const uint32_t *const v = hull->vertices;
    if (hull->vertex_count != hull->dimension + 1U || hull->face_count != 0U) {
        return "a line has two ends, and a point one";
    }
    const uint32_t a = v[0], b = v[hull->dimension];
    if (hull->dimension == 1U && (a >= b || vec3_equal(p[a], p[b]))) {
        return "the ends are in the wrong order, or equal";
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct v from = difference(p[i], p[a]), to = difference(p[b], p[i]);
        if (!is_null(normal_of(p, a, b, i)) || dot(from, to) < 0 || (a == b && !is_null(from))) {
            return "a point is not between the ends";
        }
    }
    return NULL;
}

const char *solid_check_hull(const struct vec3 *points, uint32_t count,
                             const struct solid_hull *hull) {
    const char *const wrong = check_indices(points, count, hull->vertices, hull->vertex_count);
    if (wrong != NULL) {
        return wrong;
    }
    return hull->dimension == 3U   ? check_solid(points, count, hull)
           : hull->dimension == 2U ? check_flat(points, count, hull)
                                   : check_line(points, count, hull);
}

// ---------------------------------------------------------------- spheres

static void set_dot(mpq_t out, struct v a, struct v b) {
    mpz_t z;
    mpz_init(z);
    set_wide(z, dot(a, b));
    mpq_set_z(out, z);
    mpz_clear(z);
}

/// Weights w of the edges e, with 2 sum_j w_j e_i . e_j = |e_i|^2: sum_j w_j e_j is the centre.
static bool solve_weights(const struct v *e, int n, mpq_t *w) {
    mpq_t m[3][4], factor;
    mpq_init(factor);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) {
            mpq_init(m[i][k]);
        }
    }
    bool good = true;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            set_dot(m[i][k], e[i], e[k]);
            mpq_mul_2exp(m[i][k], m[i][k], 1);
        }
        set_dot(m[i][3], e[i], e[i]);
    }
    for (int i = 0; i < n && good; i++) { // the matrix is positive definite: no pivoting
        good = mpq_sgn(m[i][i]) != 0;
        for (int row = 0; row < n && good; row++) {
            if (row == i) {
                continue;
            }
            mpq_div(factor, m[row][i], m[i][i]);
            for (int k = 0; k < 4; k++) {
                mpq_t part;
                mpq_init(part);
                mpq_mul(part, factor, m[i][k]);
                mpq_sub(m[row][k], m[row][k], part);
                mpq_clear(part);
            }
        }
    }
    for (int i = 0; i < n && good; i++) {
        mpq_div(w[i], m[i][3], m[i][i]);
    }
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) {
            mpq_clear(m[i][k]);
        }
    }
    mpq_clear(factor);
    return good;
}

/// |p - o|^2 - 2 (p - o) . center, as a rational: above 0 for points outside.
static int outside_sign(struct v d, const struct v *e, int n, mpq_t *w) {
    mpq_t sum, part;
    mpq_inits(sum, part, (mpq_ptr)NULL);
    set_dot(sum, d, d);
    for (int i = 0; i < n; i++) {
        set_dot(part, d, e[i]);
        mpq_mul_2exp(part, part, 1);
        mpq_mul(part, part, w[i]);
        mpq_sub(sum, sum, part);
    }
    const int sign = mpq_sgn(sum);
    mpq_clears(sum, part, (mpq_ptr)NULL);
    return sign;
}

static wide component(struct v a, int axis) {
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

/// Is the reported centre the true one, rounded?
static bool center_is_rounded(struct v origin, struct v reported_q30, const struct v *e, int n,
                              mpq_t *w) {
    mpq_t sum, part;
    mpz_t z;
    mpq_inits(sum, part, (mpq_ptr)NULL);
    mpz_init(z);
    bool good = true;
    for (int axis = 0; axis < 3; axis++) {
        set_wide(z, component(origin, axis));
        mpq_set_z(sum, z);
        for (int i = 0; i < n; i++) {
            set_wide(z, component(e[i], axis));
            mpq_set_z(part, z);
            mpq_mul(part, part, w[i]);
            mpq_add(sum, sum, part);
        }
        mpq_mul_2exp(sum, sum, 30);
        set_wide(z, component(reported_q30, axis));
        mpq_set_z(part, z);
        mpq_sub(sum, sum, part);
        mpq_abs(sum, sum);
        good = good && mpq_cmp_ui(sum, 1, 2) <= 0;
    }
    mpq_clears(sum, part, (mpq_ptr)NULL);
    mpz_clear(z);
    return good;
}

/// Does the reported sphere hold the point? And is its radius at most 5 units above its distance?
static bool holds(struct vec3 p, const struct solid_sphere *s, bool on_it) {
    const wide one = (wide)1 << 30;
    const struct v d = {p.x * one - s->center_q30.x, p.y * one - s->center_q30.y,
                        p.z * one - s->center_q30.z};
    const wide radius = (wide)s->radius_q30, low = radius > 5 ? radius - 5 : 0;
    return dot(d, d) <= radius * radius && (!on_it || dot(d, d) >= low * low);
}

const char *solid_check_sphere(const struct vec3 *points, uint32_t count,
                               const struct solid_sphere *s) {
    if (s->support_count < 1U || s->support_count > 4U) {
        return "a support has one to four points";
    }
    const int n = s->support_count - 1;
    struct v e[3];
    mpq_t w[3], sum;
    for (int i = 0; i <= n; i++) {
        if (s->support[i] >= count || (i > 0 && s->support[i] <= s->support[i - 1])) {
            return "the support is not ascending";
        }
        if (i > 0) {
            e[i - 1] = difference(points[s->support[i]], points[s->support[0]]);
        }
    }
    for (int i = 0; i < 3; i++) {
        mpq_init(w[i]);
    }
    mpq_init(sum);
    const char *wrong = solve_weights(e, n, w) ? NULL : "the support is not in general position";
    for (int i = 0; i < n && wrong == NULL; i++) {
        mpq_add(sum, sum, w[i]);
        wrong = mpq_sgn(w[i]) < 0 ? "the centre is outside the support" : NULL;
    }
    if (wrong == NULL && mpq_cmp_ui(sum, 1, 1) > 0) {
        wrong = "the centre is outside the support";
    }
    const struct vec3 o = points[s->support[0]];
    for (uint32_t i = 0; i < count && wrong == NULL; i++) {
        if (outside_sign(difference(points[i], o), e, n, w) > 0) {
            wrong = "a point is outside";
        } else if (!holds(points[i], s, i == s->support[0])) {
            wrong = "the rounded sphere does not hold a point, or is too large";
        }
    }
    const struct v center = {s->center_q30.x, s->center_q30.y, s->center_q30.z};
    if (wrong == NULL && !center_is_rounded((struct v){o.x, o.y, o.z}, center, e, n, w)) {
        wrong = "the centre is not the true one, rounded";
    }
    for (int i = 0; i < 3; i++) {
        mpq_clear(w[i]);
    }
    mpq_clear(sum);
    return wrong;
}

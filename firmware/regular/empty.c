#include "regular/empty.h"

#include "sphere/voronoi_mesh.h"

#define ONE_Q61 ((int64_t)1 << 61)

void empty_open(struct empty *empty, uint32_t count, struct arena *arena) {
    const uint64_t sites = 2U * (uint64_t)count;
    *empty = (struct empty){.count = count};
    empty->both = arena_take(arena, sites, sizeof *empty->both);
    empty->mesh = arena_take(arena, VORONOI_MESH_BYTES(sites), 1);
    empty->scratch = arena_take(arena, VORONOI_INSERT_BYTES(sites), 1);
}

static bool is_zero(struct vec3_i64 a) {
    return (a.x | a.y | a.z) == 0;
}

/// All lines in one plane: *pole is at right angles to them.
static bool in_one_plane(const struct empty *empty, struct vec3_i64 *pole) {
    const struct vec3 first = empty->lines[0];
    *pole = (struct vec3_i64){0, 0, 0};
    for (uint32_t i = 1; i < empty->count; i++) {
        if (is_zero(*pole)) {
            *pole = vec3_cross(first, empty->lines[i]);
        } else if (i128_sign(vec3_i64_dot_vec3(*pole, empty->lines[i])) != 0) {
            return false;
        }
    }
    if (is_zero(*pole)) { // all on one line
        *pole = (first.x | first.y) != 0 ? (struct vec3_i64){-(int64_t)first.y, first.x, 0}
                                         : (struct vec3_i64){1, 0, 0};
    }
    return true;
}

/// A number that is within error of value.
struct about {
    int64_t value_q61, error_q61;
};

static unsigned bits_i128(struct i128 a) {
    const struct i128 size = i128_sign(a) < 0 ? i128_neg(a) : a;
    return size.hi != 0 ? 128U - u64_leading_zeros((uint64_t)size.hi)
                        : 64U - u64_leading_zeros(size.lo);
}

static int64_t shift_right(struct i128 a, unsigned shift) {
    return i256_shift_right_i64(i256_from_i128(a), shift);
}

static unsigned max_bits(unsigned a, unsigned b) {
    return a > b ? a : b;
}

static unsigned size_bits(struct vec3_i64 a) {
    return 64U - u64_leading_zeros(u64_abs(a.x) | u64_abs(a.y) | u64_abs(a.z));
}

/// The axis of the circle through three sites, out of the hull, and the cosine of its radius. The
/// differences are off by 1 a component, so the normal by less than 4 times the larger one, and 2.
static struct about cosine_of(const struct site *a, const struct site *b, const struct site *c,
                              struct vec3_i64 *axis) {
    const struct vec3_i64 u = vec3_i64_sub(b->unit_q61, a->unit_q61);
    const struct vec3_i64 v = vec3_i64_sub(c->unit_q61, a->unit_q61);
    const struct vec3_i128 normal = vec3_i64_cross(u, v);
    const unsigned bits =
        max_bits(bits_i128(normal.x), max_bits(bits_i128(normal.y), bits_i128(normal.z)));
    const unsigned error_bits = max_bits(size_bits(u), size_bits(v)) + 4U;
    if (bits < error_bits + 4U) {
        *axis = (struct vec3_i64){0, 0, 0};
        return (struct about){0, ONE_Q61};
    }
    const unsigned drop = bits > 60U ? bits - 60U : 0U;
    *axis = disc_unit_q61((struct vec3_i64){
        shift_right(normal.x, drop), shift_right(normal.y, drop), shift_right(normal.z, drop)});
    const struct i128 cosine = vec3_i64_dot(*axis, a->unit_q61);
    // The normal is at least 2^(bits - 1) long; its error, and that of three roundings.
    const unsigned error = error_bits + 62U - bits;
    return (struct about){shift_right(cosine, 61),
                          ((int64_t)1 << (error > 61U ? 61U : error)) + 64};
}

static struct vec3_i64 wide_site(const struct voronoi_mesh *mesh, uint32_t site) {
    return vec3_widen(mesh->site[site].vector);
}

static void search(struct empty *empty, const struct voronoi_mesh *mesh, struct disc *disc) {
    struct about best = {0, 0};
    disc->count = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *const site = mesh->triangle[t].site;
        struct vec3_i64 axis;
        const struct about cosine =
            cosine_of(&mesh->site[site[0]], &mesh->site[site[1]], &mesh->site[site[2]], &axis);
        empty->operations++;
        // The set is symmetric: of two opposite circles the upper one is enough.
        if (axis.z < -cosine.error_q61 ||
            (disc->count != 0U &&
             cosine.value_q61 - cosine.error_q61 > best.value_q61 + best.error_q61)) {
            continue;
        }
        const struct disc here = {
            3, {wide_site(mesh, site[0]), wide_site(mesh, site[1]), wide_site(mesh, site[2])}};
        if (disc->count == 0U ||
            cosine.value_q61 + cosine.error_q61 < best.value_q61 - best.error_q61 ||
            disc_compare(&here, disc) < 0) {
            *disc = here;
            best = cosine;
        }
    }
}

void empty_largest(struct empty *empty, struct disc *disc) {
    struct vec3_i64 pole;
    if (in_one_plane(empty, &pole)) {
        *disc = (struct disc){1, {pole}};
        return;
    }
    for (uint32_t i = 0; i < empty->count; i++) {
        empty->both[2U * i] = empty->lines[i];
        empty->both[2U * i + 1U] = vec3_neg(empty->lines[i]);
    }
    struct voronoi_mesh mesh = {.side_tests = 0};
    voronoi_sites(&mesh, empty->mesh, empty->both, NULL, 2U * empty->count, empty->scratch);
    voronoi_insert(&mesh, empty->scratch);
    empty->operations += mesh.side_tests;
    search(empty, &mesh, disc);
}

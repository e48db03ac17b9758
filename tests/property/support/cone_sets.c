#include "property/support/cone_sets.h"

#include "check.h"

#include <math.h>

const char *const cone_class_names[CLASS_COUNT] = {"cap",
                                                   "cap, mixed lengths",
                                                   "ring",
                                                   "ring 89..89.999",
                                                   "ring 89.999..90",
                                                   "narrow",
                                                   "sphere",
                                                   "grid",
                                                   "half grid",
                                                   "great circle",
                                                   "circle",
                                                   "antipodal",
                                                   "border",
                                                   "int32 ends",
                                                   "repeated"};

const char *const cone_large_class_names[LARGE_COUNT] = {
    "cap",          "ring",   "normal",     "spiral", "grid",
    "great circle", "circle", "hemisphere", "sphere", "blocked"};

#define PI 3.14159265358979323846

static const double degree = PI / 180.0;

double cone_sets_uniform(uint64_t *random) {
    return (double)(check_random(random) >> 11) * 0x1p-53;
}

static uint32_t below(uint64_t *random, uint32_t limit) {
    return (uint32_t)((check_random(random) >> 32) * limit >> 32);
}

static int32_t between(uint64_t *random, int32_t low, int32_t high) {
    return low + (int32_t)below(random, (uint32_t)(high - low) + 1U);
}

/// Logarithmically even between low and high.
static double spread(uint64_t *random, double low, double high) {
    return low * pow(high / low, cone_sets_uniform(random));
}

bool cone_sets_is_unit(struct vec3 v) {
    const long double x = v.x, y = v.y, z = v.z;
    return fabsl(sqrtl(x * x + y * y + z * z) - 0x1p30L) <= 2.0L;
}

struct vec3 cone_sets_normalise(struct vec3 v) {
    const long double x = v.x, y = v.y, z = v.z, scale = 0x1p30L / sqrtl(x * x + y * y + z * z);
    return vec3((int32_t)llroundl(x * scale), (int32_t)llroundl(y * scale),
                (int32_t)llroundl(z * scale));
}

// ---------------------------------------------------------------- directions around a middle

/// An orthonormal base whose third vector is the middle of a cap.
struct base {
    double right[3], up[3], ahead[3];
};

static void cross(double *to, const double *a, const double *b) {
    to[0] = a[1] * b[2] - a[2] * b[1];
    to[1] = a[2] * b[0] - a[0] * b[2];
    to[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalise(double *a) {
    const double length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    for (unsigned i = 0; i < 3U; i++) {
        a[i] /= length;
    }
}

static struct base any_base(uint64_t *random) {
    struct base base = {.right = {0.0}, .up = {0.0}, .ahead = {0.0}};
    if (below(random, 8) == 0U) { // exactly along an axis: products with zero
        base.ahead[below(random, 3)] = 1.0;
    } else {
        const double z = 2.0 * cone_sets_uniform(random) - 1.0, rest = sqrt(1.0 - z * z);
        const double turn = 2.0 * PI * cone_sets_uniform(random);
        base.ahead[0] = rest * cos(turn);
        base.ahead[1] = rest * sin(turn);
        base.ahead[2] = z;
    }
    double other[3] = {0.0, 0.0, 0.0};
    other[fabs(base.ahead[0]) < 0.6 ? 0 : 1] = 1.0;
    cross(base.right, other, base.ahead);
    normalise(base.right);
    cross(base.up, base.ahead, base.right);
    return base;
}

/// The vector of that length at `angle` from the middle, rounded.
static struct vec3 at(const struct base *base, double angle, double turn, double length) {
    const double side = sin(angle) * cos(turn), rise = sin(angle) * sin(turn), front = cos(angle);
    int32_t rounded[3];
    for (unsigned i = 0; i < 3U; i++) {
        const double component =
            side * base->right[i] + rise * base->up[i] + front * base->ahead[i];
        rounded[i] = (int32_t)llround(component * length);
    }
    return vec3(rounded[0], rounded[1], rounded[2]);
}

/// Uniform on the cap: sin(angle / 2) grows with the root of the area.
static double angle_in_cap(uint64_t *random, double half_angle) {
    return 2.0 * asin(sqrt(cone_sets_uniform(random)) * sin(half_angle / 2.0));
}

static double any_turn(uint64_t *random) {
    return 2.0 * PI * cone_sets_uniform(random);
}

static void fill_cap(uint64_t *random, struct vec3 *points, uint32_t count, double half_angle,
                     bool on_rim) {
    const struct base base = any_base(random);
    for (uint32_t i = 0; i < count; i++) {
        const double angle = on_rim ? half_angle : angle_in_cap(random, half_angle);
        points[i] = at(&base, angle, any_turn(random), 0x1p30);
    }
}

static void fill_cap_mixed(uint64_t *random, struct vec3 *points, uint32_t count) {
    const struct base base = any_base(random);
    const double half_angle = spread(random, 1e-6, 89.99 * degree);
    for (uint32_t i = 0; i < count; i++) {
        const double angle = angle_in_cap(random, half_angle), turn = any_turn(random);
        points[i] = at(&base, angle, turn, spread(random, 0x1p8, 2147483646.0));
    }
}

static void fill_narrow(uint64_t *random, struct vec3 *points, uint32_t count) {
    const struct base base = any_base(random);
    const struct vec3 middle = at(&base, 0.0, 0.0, 0x1p30);
    const int32_t reach = between(random, 0, 900);
    for (uint32_t i = 0; i < count; i++) {
        points[i] = vec3(middle.x + between(random, -reach, reach),
                         middle.y + between(random, -reach, reach),
                         middle.z + between(random, -reach, reach));
        points[i] = cone_sets_normalise(points[i]);
    }
}

// ---------------------------------------------------------------- integers

static struct vec3 any_of_grid(uint64_t *random, int32_t reach, int32_t z_low) {
    for (;;) {
        const struct vec3 v = vec3(between(random, -reach, reach), between(random, -reach, reach),
                                   between(random, z_low, reach));
        if ((v.x | v.y | v.z) != 0) {
            return v;
        }
    }
}

static void fill_grid(uint64_t *random, struct vec3 *points, uint32_t count, bool half) {
    const int32_t reach = between(random, 1, 4);
    const uint32_t axis = below(random, 3);
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 v = any_of_grid(random, reach, half ? 0 : -reach);
        points[i] = axis == 0U ? v : (axis == 1U ? vec3(v.z, v.x, v.y) : vec3(v.y, v.z, v.x));
    }
}

/// a i + b j with integers i, j: exactly in the plane of a and b.
static void fill_arc(uint64_t *random, struct vec3 *points, uint32_t count) {
    const int32_t size = 1 << between(random, 2, 19);
    const struct vec3 a = any_of_grid(random, size, -size), b = any_of_grid(random, size, -size);
    const int32_t reach = 1 << between(random, 1, 10);
    const int32_t low = below(random, 3) == 0U ? -reach : 0;
    for (uint32_t i = 0; i < count; i++) {
        do {
            const int32_t m = between(random, low, reach), n = between(random, low, reach);
            points[i] = vec3(m * a.x + n * b.x, m * a.y + n * b.y, m * a.z + n * b.z);
        } while ((points[i].x | points[i].y | points[i].z) == 0);
    }
}

/// Integer points of the circle x^2 + y^2 = 65^2 at one height, turned by a cube's symmetry.
static void fill_circle(uint64_t *random, struct vec3 *points, uint32_t count) {
    static const int32_t leg[][2] = {{65, 0}, {63, 16}, {60, 25}, {56, 33}, {52, 39}};
    static const int32_t heights[] = {0, 1, 2, 65, 72, 156, 1000, 1000000, 20000000};
    const int32_t height = heights[below(random, 9)] * (below(random, 2) != 0U ? 1 : -1);
    const int32_t scale = 1 << below(random, height > 1000000 || height < -1000000 ? 6 : 10);
    const uint32_t axis = below(random, 3);
    const bool half_only = below(random, 2) == 0U;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t *legs = leg[below(random, 5)];
        const bool swap = below(random, 2) != 0U;
        int32_t x = swap ? legs[1] : legs[0], y = swap ? legs[0] : legs[1];
        x = below(random, 2) != 0U ? x : -x;
        y = below(random, 2) != 0U && !half_only ? -y : y;
        const int32_t c[3] = {x * scale, y * scale, height * scale};
        points[i] = vec3(c[axis], c[(axis + 1U) % 3U], c[(axis + 2U) % 3U]);
    }
}

static int32_t nudge(uint64_t *random, int32_t component) {
    const int32_t by = between(random, -1, 1);
    return component > INT32_MAX - 2 || component < INT32_MIN + 2 ? component : component + by;
}

static struct vec3 nudged(uint64_t *random, struct vec3 v) {
    const struct vec3 beside = vec3(nudge(random, v.x), nudge(random, v.y), nudge(random, v.z));
    return (beside.x | beside.y | beside.z) == 0 ? v : beside;
}

/// Vectors with a positive part along `side`, so that zero stays on the border of the hull.
static struct vec3 in_front(uint64_t *random, struct vec3 normal, int32_t size) {
    const struct vec3 v = any_of_grid(random, size, -size);
    const int64_t dot = (int64_t)v.x * normal.x + (int64_t)v.y * normal.y + (int64_t)v.z * normal.z;
    return dot < 0 ? vec3(-v.x, -v.y, -v.z) : v;
}

static void fill_antipodal(uint64_t *random, struct vec3 *points, uint32_t count) {
    const int32_t size = 1 << between(random, 1, 29);
    const struct vec3 a = any_of_grid(random, size, -size), side = any_of_grid(random, 9, -9);
    for (uint32_t i = 0; i < count; i++) {
        points[i] = in_front(random, side, size);
    }
    if (count > 1U) {
        const uint32_t at_index = below(random, count);
        points[at_index] = a;
        const struct vec3 opposite = vec3(-a.x, -a.y, -a.z);
        points[(at_index + 1U) % count] =
            below(random, 2) != 0U ? opposite : nudged(random, opposite);
    }
}

/// a, b and -(i a + j b), the last one unit beside; the others all on one side of their plane.
static void fill_boundary(uint64_t *random, struct vec3 *points, uint32_t count) {
    const int32_t size = 1 << between(random, 1, 26), reach = 1 << between(random, 0, 3);
    const struct vec3 a = any_of_grid(random, size, -size), b = any_of_grid(random, size, -size);
    const int32_t i = between(random, 1, reach), j = between(random, 1, reach);
    const double normal[3] = {(double)a.y * b.z - (double)a.z * b.y,
                              (double)a.z * b.x - (double)a.x * b.z,
                              (double)a.x * b.y - (double)a.y * b.x};
    const double scale = 1e6 / (fabs(normal[0]) + fabs(normal[1]) + fabs(normal[2]) + 1e-9);
    const struct vec3 side = vec3((int32_t)(normal[0] * scale), (int32_t)(normal[1] * scale),
                                  (int32_t)(normal[2] * scale));
    for (uint32_t k = 0; k < count; k++) {
        points[k] = in_front(random, side, size);
    }
    if (count >= 3U) {
        struct vec3 c = vec3(-i * a.x - j * b.x, -i * a.y - j * b.y, -i * a.z - j * b.z);
        if ((c.x | c.y | c.z) == 0) {
            c = vec3(-a.x, -a.y, -a.z);
        }
        const uint32_t at_index = below(random, count);
        points[at_index] = a;
        points[(at_index + 1U) % count] = b;
        points[(at_index + 2U) % count] = below(random, 3) == 0U ? c : nudged(random, c);
    }
}

static int32_t any_end(uint64_t *random) {
    static const int32_t ends[] = {INT32_MIN, INT32_MIN + 1, -(1 << 30),    -2,       -1, 0, 1,
                                   2,         1 << 30,       INT32_MAX - 1, INT32_MAX};
    return ends[below(random, 11)];
}

static void fill_extremes(uint64_t *random, struct vec3 *points, uint32_t count) {
    const int32_t z_low = below(random, 2) != 0U ? INT32_MIN : 0;
    for (uint32_t i = 0; i < count; i++) {
        do {
            points[i] = vec3(any_end(random), any_end(random), any_end(random));
            if (z_low == 0 && points[i].z < 0) {
                points[i].z = ~points[i].z;
            }
        } while ((points[i].x | points[i].y | points[i].z) == 0);
    }
}

static void fill_repeated(uint64_t *random, struct vec3 *points, uint32_t count) {
    struct vec3 direction[4];
    const int32_t size = 1 << between(random, 1, 20);
    const uint32_t kinds = 1U + below(random, 4);
    for (uint32_t i = 0; i < kinds; i++) {
        direction[i] = any_of_grid(random, size, below(random, 3) != 0U ? 0 : -size);
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct vec3 v = direction[below(random, kinds)];
        const int32_t factor = between(random, 1, 1 << below(random, 11));
        points[i] = vec3(v.x * factor, v.y * factor, v.z * factor);
    }
}

uint32_t cone_sets_draw(enum cone_class class, uint64_t *random, struct vec3 *points) {
    const uint32_t count = 1U + below(random, CONE_SETS_SMALL_MAX);
    switch (class) {
    case CLASS_CAP:
    case CLASS_RING:
        fill_cap(random, points, count, spread(random, 1e-6, 89.99 * degree), class == CLASS_RING);
        break;
    case CLASS_CAP_MIXED:
        fill_cap_mixed(random, points, count);
        break;
    case CLASS_RING_WIDE:
        fill_cap(random, points, count, PI / 2.0 - spread(random, 1e-3, 1.0) * degree, true);
        break;
    case CLASS_RING_SHARP:
        fill_cap(random, points, count, PI / 2.0 - spread(random, 1e-8, 1e-3) * degree, true);
        break;
    case CLASS_NARROW:
        fill_narrow(random, points, count);
        break;
    case CLASS_SPHERE:
        fill_cap(random, points, count, PI, false);
        break;
    case CLASS_GRID:
    case CLASS_HALF_GRID:
        fill_grid(random, points, count, class == CLASS_HALF_GRID);
        break;
    case CLASS_ARC:
        fill_arc(random, points, count);
        break;
    case CLASS_CIRCLE:
        fill_circle(random, points, count);
        break;
    case CLASS_ANTIPODAL:
        fill_antipodal(random, points, count);
        break;
    case CLASS_BOUNDARY:
        fill_boundary(random, points, count);
        break;
    case CLASS_EXTREMES:
        fill_extremes(random, points, count);
        break;
    default:
        fill_repeated(random, points, count);
        break;
    }
    return count;
}

uint32_t cone_sets_of_bits(uint32_t bits, uint32_t limit, struct vec3 *points) {
    uint32_t count = 0;
    for (uint32_t rest = bits; rest != 0U; rest &= rest - 1U) {
        if (++count > limit) {
            return 0;
        }
    }
    count = 0;
    for (int32_t i = 0; i < 26; i++) {
        if ((bits >> i & 1U) != 0U) {
            const int32_t cell = i < 13 ? i : i + 1; // of 27; the middle one is zero
            points[count++] = vec3(cell / 9 - 1, cell / 3 % 3 - 1, cell % 3 - 1);
        }
    }
    return count;
}

void cone_sets_shuffle(uint64_t *random, struct vec3 *points, uint32_t count) {
    for (uint32_t i = count; i > 1U; i--) {
        const uint32_t j = below(random, i);
        const struct vec3 swap = points[i - 1U];
        points[i - 1U] = points[j];
        points[j] = swap;
    }
}

// ---------------------------------------------------------------- larger sets

static void fill_normal(uint64_t *random, struct vec3 *points, uint32_t count) {
    const struct base base = any_base(random);
    const double sigma = spread(random, 1e-4, 0.5);
    for (uint32_t i = 0; i < count; i++) {
        const double radius = sqrt(-2.0 * log(1.0 - cone_sets_uniform(random)));
        points[i] = at(&base, fmin(sigma * radius, 89.0 * degree), any_turn(random), 0x1p30);
    }
}

static void fill_spiral(uint64_t *random, struct vec3 *points, uint32_t count) {
    const struct base base = any_base(random);
    const double half_angle = spread(random, 1e-4, 80.0 * degree);
    for (uint32_t i = 0; i < count; i++) {
        points[i] = at(&base, half_angle * ((double)i + 1.0) / count, 2.399963 * i, 0x1p30);
    }
}

void cone_sets_draw_large(enum cone_large_class class, uint64_t *random, struct vec3 *points,
                          uint32_t count) {
    switch (class) {
    case LARGE_CAP:
    case LARGE_RING:
        fill_cap(random, points, count, spread(random, 1e-6, 89.0 * degree), class == LARGE_RING);
        break;
    case LARGE_NORMAL:
        fill_normal(random, points, count);
        break;
    case LARGE_SPIRAL:
        fill_spiral(random, points, count);
        break;
    case LARGE_GRID:
        for (uint32_t i = 0; i < count; i++) {
            points[i] = any_of_grid(random, 50, 1);
        }
        break;
    case LARGE_ARC:
        fill_arc(random, points, count);
        break;
    case LARGE_CIRCLE:
        fill_circle(random, points, count);
        break;
    case LARGE_HEMISPHERE:
        fill_cap(random, points, count, PI / 2.0 - spread(random, 1e-4, 0.1) * degree, false);
        break;
    case LARGE_SPHERE:
        fill_cap(random, points, count, PI, false);
        break;
    default: {
        const struct base base = any_base(random);
        for (uint32_t i = 0; i + 1U < count; i++) {
            points[i] = at(&base, angle_in_cap(random, 85.0 * degree), any_turn(random), 0x1p30);
        }
        points[count - 1U] = at(&base, PI, 0.0, 0x1p30);
        break;
    }
    }
}

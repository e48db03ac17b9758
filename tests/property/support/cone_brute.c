#include "property/support/cone_brute.h"

#include <float.h>
#include <math.h>

_Static_assert(LDBL_MANT_DIG >= 64, "the reference needs 64-bit mantissas");

__extension__ typedef __int128 int128;

void brute_set(struct brute *brute, const struct vec3 *points, unsigned count) {
    brute->count = count;
    for (unsigned i = 0; i < count; i++) {
        const long double x = points[i].x, y = points[i].y, z = points[i].z;
        const long double length = sqrtl(x * x + y * y + z * z); // the sum is exact: 64 bits
        brute->point[i] = points[i];
        brute->length[i] = length;
        brute->unit[i][0] = x / length;
        brute->unit[i][1] = y / length;
        brute->unit[i][2] = z / length;
    }
}

// ---------------------------------------------------------------- exact integers

struct normal {
    int64_t x, y, z;
};

static struct normal cross(struct vec3 a, struct vec3 b) {
    return (struct normal){(int64_t)a.y * b.z - (int64_t)a.z * b.y,
                           (int64_t)a.z * b.x - (int64_t)a.x * b.z,
                           (int64_t)a.x * b.y - (int64_t)a.y * b.x};
}

static int128 det(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct normal n = cross(a, b);
    return (int128)n.x * c.x + (int128)n.y * c.y + (int128)n.z * c.z;
}

static int sign(int128 a) {
    return a > 0 ? 1 : (a < 0 ? -1 : 0);
}

int brute_det_sign(struct vec3 a, struct vec3 b, struct vec3 c) {
    return sign(det(a, b, c));
}

static bool is_zero(struct normal n) {
    return (n.x | n.y | n.z) == 0;
}

int brute_parallel(struct vec3 a, struct vec3 b) {
    if (!is_zero(cross(a, b))) {
        return 0;
    }
    return sign((int128)((int64_t)a.x * b.x) + (int64_t)a.y * b.y + (int64_t)a.z * b.z);
}

/// Do the two normals of one plane point the same way? Neither is zero.
static bool same_way(struct normal a, struct normal b) {
    return (a.x > 0) == (b.x > 0) && (a.x < 0) == (b.x < 0) && (a.y > 0) == (b.y > 0) &&
           (a.y < 0) == (b.y < 0) && (a.z > 0) == (b.z > 0) && (a.z < 0) == (b.z < 0);
}

/// Three coplanar vectors, no two of them parallel: each turns the same way to the next.
static bool three_surround_zero(struct vec3 a, struct vec3 b, struct vec3 c) {
    const struct normal ab = cross(a, b), bc = cross(b, c), ca = cross(c, a);
    return !is_zero(ab) && !is_zero(bc) && !is_zero(ca) && same_way(ab, bc) && same_way(bc, ca);
}

bool brute_zero_in_hull(const struct vec3 *points, unsigned count) {
    int8_t side[BRUTE_COUNT_MAX][BRUTE_COUNT_MAX][BRUTE_COUNT_MAX];
    for (unsigned a = 0; a < count; a++) {
        for (unsigned b = a + 1U; b < count; b++) {
            if (brute_parallel(points[a], points[b]) < 0) {
                return true;
            }
            for (unsigned c = b + 1U; c < count; c++) {
                side[a][b][c] = (int8_t)brute_det_sign(points[a], points[b], points[c]);
                if (side[a][b][c] == 0 && three_surround_zero(points[a], points[b], points[c])) {
                    return true;
                }
            }
        }
    }
    for (unsigned a = 0; a < count; a++) {
        for (unsigned b = a + 1U; b < count; b++) {
            for (unsigned c = b + 1U; c < count; c++) {
                const int abc = side[a][b][c];
                for (unsigned d = c + 1U; d < count && abc != 0; d++) {
                    if (side[a][b][d] == -abc && side[a][c][d] == abc && side[b][c][d] == -abc) {
                        return true;
                    }
                }
            }
        }
    }
    return false;
}

// ---------------------------------------------------------------- angles

/// Two points nearer than this count as one in triples: it moves the optimum by 0.01 nrad at most,
/// and keeps the rounding of the unit vectors (1e-19) out of the shape of the triangles.
#define NEAR_CHORD2 1e-22L

/// From this squared radius on the cone's plane passes the centre within 1e-3, and its distance
/// tells the angle better than the radius.
#define NEAR_QUARTER_R2 (1.0L - 1e-6L)

/// The largest need found so far, and whether rounding left it open.
struct need {
    long double radius2;  // of the circle, below NEAR_QUARTER_R2; 0 at first
    long double distance; // of the plane from the centre, if smaller than 1e-3; 1 at first
    bool uncertain;
};

static void add_need(struct need *need, long double radius2, long double distance) {
    if (radius2 < NEAR_QUARTER_R2) {
        need->radius2 = radius2 > need->radius2 ? radius2 : need->radius2;
    } else {
        need->distance = distance < need->distance ? distance : need->distance;
    }
}

static long double norm2(const long double *a) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
}

static long double chord2(const struct brute *brute, unsigned i, unsigned j) {
    const long double *a = brute->unit[i], *b = brute->unit[j];
    const long double difference[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return norm2(difference);
}

static void need_of_two(const struct brute *brute, unsigned i, unsigned j, long double chord2_ij,
                        struct need *need) {
    const long double *a = brute->unit[i], *b = brute->unit[j];
    const long double sum[3] = {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
    add_need(need, chord2_ij / 4.0L, sqrtl(norm2(sum)) / 2.0L);
}

/// A side shorter than 1e-7 leaves the angles at its ends uncertain by 1e-12 and more, which only
/// matters where the others are almost diameters.
#define SHORT_CHORD2 1e-14L
#define LONG_CHORD2  (4.0L * NEAR_QUARTER_R2)

static bool is_uncertain(long double a2, long double b2, long double c2) {
    return fminl(a2, fminl(b2, c2)) < SHORT_CHORD2 && fmaxl(a2, fmaxl(b2, c2)) > LONG_CHORD2;
}

/// Three points need more than two of them only if their triangle is acute. a2, b2 and c2 are the
/// squared sides opposite i, j and k.
static void need_of_three(const struct brute *brute, unsigned i, unsigned j, unsigned k,
                          long double a2, long double b2, long double c2, struct need *need) {
    if (fminl(a2, fminl(b2, c2)) < NEAR_CHORD2) {
        return;
    }
    need->uncertain = need->uncertain || is_uncertain(a2, b2, c2);
    if (a2 >= b2 + c2 || b2 >= a2 + c2 || c2 >= a2 + b2) {
        return;
    }
    // The product of the shortest side with another: that of two long ones would lose digits.
    const unsigned first = c2 <= a2 && c2 <= b2 ? i : (a2 <= b2 ? j : k);
    const unsigned second = first == i ? j : (first == j ? k : i);
    const long double *p = brute->unit[first], *q = brute->unit[second];
    const long double *r = brute->unit[i ^ j ^ k ^ first ^ second];
    const long double u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    const long double w[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    const long double n[3] = {u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2],
                              u[0] * w[1] - u[1] * w[0]};
    const long double area2 = norm2(n);
    const long double radius2 = a2 * b2 * c2 / (4.0L * area2);
    long double distance = 1.0L;
    if (radius2 >= NEAR_QUARTER_R2) {
        const int128 volume = det(brute->point[i], brute->point[j], brute->point[k]);
        distance = fabsl((long double)volume) /
                   (brute->length[i] * brute->length[j] * brute->length[k] * sqrtl(area2));
    }
    add_need(need, radius2, distance);
}

long double brute_half_angle(const struct brute *brute, bool *sharp) {
    long double side2[BRUTE_COUNT_MAX][BRUTE_COUNT_MAX];
    struct need need = {0.0L, 1.0L, false};
    for (unsigned i = 0; i < brute->count; i++) {
        for (unsigned j = 0; j < i; j++) {
            side2[j][i] = chord2(brute, j, i);
            need_of_two(brute, j, i, side2[j][i], &need);
        }
    }
    for (unsigned i = 0; i < brute->count; i++) {
        for (unsigned j = i + 1U; j < brute->count; j++) {
            for (unsigned k = j + 1U; k < brute->count; k++) {
                need_of_three(brute, i, j, k, side2[j][k], side2[i][k], side2[i][j], &need);
            }
        }
    }
    *sharp = !need.uncertain;
    if (need.distance < 1.0L) {
        return atan2l(sqrtl(1.0L - need.distance * need.distance), need.distance);
    }
    return asinl(sqrtl(need.radius2));
}

long double brute_largest_angle(const struct brute *brute, struct vec3 axis) {
    long double largest = 0.0L;
    for (unsigned i = 0; i < brute->count; i++) {
        const struct vec3 p = brute->point[i];
        const struct normal n = cross(axis, p);
        const long double across[3] = {(long double)n.x, (long double)n.y, (long double)n.z};
        const long double ahead =
            (long double)((int128)axis.x * p.x + (int128)axis.y * p.y + (int128)axis.z * p.z);
        const long double angle = atan2l(sqrtl(norm2(across)), ahead);
        largest = angle > largest ? angle : largest;
    }
    return largest;
}

#include "check.h"
#include "property/support/solid_check.h"

#include <math.h>

const char *const solid_class_names[SOLID_CLASS_COUNT] = {
    "cube", "ball", "shell", "grid", "flat", "nearly flat", "line", "ends", "repeated", "lattice"};

uint32_t solid_below(uint64_t *random, uint32_t limit) {
    return (uint32_t)((check_random(random) >> 32) * limit >> 32);
}

static double uniform(uint64_t *random) {
    return (double)(check_random(random) >> 11) * 0x1p-52 - 1.0;
}

static int32_t cut(double value) {
    return value > 2147483647.0    ? INT32_MAX
           : value < -2147483648.0 ? INT32_MIN
                                   : (int32_t)llrint(value);
}

static struct vec3 in_ball(uint64_t *random, double size, bool on_shell) {
    double x, y, z, r;
    do {
        x = uniform(random);
        y = uniform(random);
        z = uniform(random);
        r = sqrt(x * x + y * y + z * z);
    } while (r > 1.0 || r < 0.01);
    const double scale = on_shell ? size / r : size;
    return vec3(cut(x * scale), cut(y * scale), cut(z * scale));
}

/// A multiple of whole vectors, so that collinear and coplanar points are exactly so.
static struct vec3 combined(struct vec3 at, struct vec3 a, int32_t s, struct vec3 b, int32_t t) {
    return vec3(at.x + s * a.x + t * b.x, at.y + s * a.y + t * b.y, at.z + s * a.z + t * b.z);
}

static struct vec3 small(uint64_t *random, uint32_t size) {
    const int32_t half = (int32_t)(size / 2U);
    return vec3((int32_t)solid_below(random, size) - half,
                (int32_t)solid_below(random, size) - half,
                (int32_t)solid_below(random, size) - half);
}

static struct vec3 at_an_end(uint64_t *random) {
    static const int32_t value[6] = {INT32_MIN, INT32_MIN + 1, -1, 0, INT32_MAX - 1, INT32_MAX};
    return vec3(value[solid_below(random, 6)], value[solid_below(random, 6)],
                value[solid_below(random, 6)]);
}

void solid_draw(enum solid_class class, uint64_t *random, struct vec3 *points, uint32_t count) {
    const double size = exp2(2.0 + 14.5 * (1.0 + uniform(random)));
    const uint32_t span = 2U + solid_below(random, 8);
    const uint32_t reach = 1U << (1U + solid_below(random, 13));
    const struct vec3 at = small(random, 1U << 20), a = small(random, reach),
                      b = small(random, reach);
    const uint32_t steps = 2U + solid_below(random, 1000);
    const uint32_t kinds = 1U + solid_below(random, 6);
    for (uint32_t i = 0; i < count; i++) {
        const int32_t s = (int32_t)solid_below(random, steps),
                      t = (int32_t)solid_below(random, steps);
        switch (class) {
        case SOLID_CUBE:
            points[i] = vec3(cut(size * uniform(random)), cut(size * uniform(random)),
                             cut(size * uniform(random)));
            break;
        case SOLID_BALL:
        case SOLID_SHELL:
            points[i] = in_ball(random, size, class == SOLID_SHELL);
            break;
        case SOLID_GRID:
            points[i] = small(random, span);
            break;
        case SOLID_FLAT:
        case SOLID_NEARLY:
            points[i] = combined(at, a, s, b, t);
            points[i].z += class == SOLID_NEARLY && solid_below(random, 4) == 0U ? 1 : 0;
            break;
        case SOLID_LINE:
            points[i] = combined(at, a, s, b, 0);
            break;
        case SOLID_ENDS:
            points[i] = at_an_end(random);
            break;
        case SOLID_REPEATED:
            points[i] =
                i < kinds ? in_ball(random, size, false) : points[solid_below(random, kinds)];
            break;
        default:
            points[i] = vec3(3 * (int32_t)solid_below(random, 4) + (int32_t)solid_below(random, 2),
                             3 * (int32_t)solid_below(random, 4) + (int32_t)solid_below(random, 2),
                             3 * (int32_t)solid_below(random, 3) + (int32_t)solid_below(random, 2));
            break;
        }
    }
}

#include "bench/levine/clouds.h"

#include "check.h"

#include <math.h>

const char *cloud_name(enum cloud cloud) {
    static const char *const names[] = {"cube 1",   "cube 2",   "cube 4",  "polyhedron", "sphere 1",
                                        "sphere 2", "sphere 4", "ellipse", "shell"};
    return names[cloud];
}

uint32_t cloud_steps(enum cloud cloud) {
    return cloud <= CLOUD_CUBE4                                  ? 8U
           : cloud == CLOUD_POLYHEDRON || cloud == CLOUD_ELLIPSE ? 7U
                                                                 : 6U;
}

uint64_t cloud_seed(enum cloud cloud, uint32_t count, uint32_t index) {
    // The finaliser of splitmix64: neighbouring cases have nothing in common.
    uint64_t x = ((uint64_t)cloud + 1U) * UINT64_C(0x9E3779B97F4A7C15) +
                 count * UINT64_C(0xD1B54A32D192ED03) + index * UINT64_C(0x8CB92BA72F3D8DD7);
    x = (x ^ x >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ x >> 27) * UINT64_C(0x94D049BB133111EB);
    x ^= x >> 31;
    return x != 0U ? x : 1U;
}

/// Above 0, below 1.
static double uniform(uint64_t *random) {
    return ((double)(check_random(random) >> 11) + 0.5) * 0x1p-53;
}

double cloud_normal(uint64_t *random, double *spare) {
    if (!isnan(*spare)) {
        const double second = *spare;
        *spare = NAN;
        return second;
    }
    const double t1 = sqrt(-2.0 * log(uniform(random))), t2 = 2.0 * M_PI * uniform(random);
    *spare = t1 * cos(t2);
    return t1 * sin(t2);
}

static struct vec3 to_units(const double p[3]) {
    return vec3((int32_t)lrint(p[0] * CLOUD_UNIT), (int32_t)lrint(p[1] * CLOUD_UNIT),
                (int32_t)lrint(p[2] * CLOUD_UNIT));
}

static double square_of(const double p[3]) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
}

/// One number of a normal cube: the next that is within the limit.
static double normal_within(uint64_t *random, double *spare, double limit) {
    double value;
    do {
        value = cloud_normal(random, spare);
    } while (!(fabs(value) < limit));
    return value;
}

static bool is_of(enum cloud cloud, const double p[3], double limit) {
    return cloud == CLOUD_ELLIPSE ? p[0] * p[0] / 4.0 + p[1] * p[1] + p[2] * p[2] <= 1.0
           : cloud == CLOUD_SHELL ? square_of(p) > 0
                                  : square_of(p) <= limit * limit;
}

static void draw_point(enum cloud cloud, double limit, uint64_t *random, double *spare,
                       double p[3]) {
    switch (cloud) {
    case CLOUD_CUBE1:
    case CLOUD_CUBE2:
    case CLOUD_CUBE4:
        for (int k = 0; k < 3; k++) {
            p[k] = normal_within(random, spare, limit);
        }
        return;
    case CLOUD_POLYHEDRON:
        for (int k = 0; k < 3; k++) {
            p[k] = uniform(random) * (k == 0 ? 2.0 : 1.0);
        }
        return;
    default:
        do {
            for (int k = 0; k < 3; k++) {
                p[k] = cloud == CLOUD_ELLIPSE ? 4.0 * uniform(random) - 2.0
                                              : cloud_normal(random, spare);
            }
        } while (!is_of(cloud, p, limit));
    }
}

void cloud_draw(enum cloud cloud, uint32_t count, uint32_t index, struct vec3 *out) {
    static const double limits[] = {1, 2, 4, 0, 1, 2, 4, 0, 0};
    uint64_t random = cloud_seed(cloud, count, index);
    double spare = NAN;
    for (uint32_t i = 0; i < count; i++) {
        double p[3];
        draw_point(cloud, limits[cloud], &random, &spare, p);
        if (cloud == CLOUD_SHELL) {
            const double length = sqrt(square_of(p)) / 4.0;
            for (int k = 0; k < 3; k++) {
                p[k] /= length;
            }
        }
        out[i] = to_units(p);
    }
}

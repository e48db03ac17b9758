#include "bench/sets.h"

#include <math.h>

const char *const bench_set_names[BENCH_SETS] = {
    "uniform cap 20", "truncated cone", "planar normal", "fixed silhouette",
    "on a circle",    "half a circle",  "exact circle",  "near-hemisphere",
    "spiral",         "surface (1982)", "whole sphere"};

struct direction {
    double x, y, z;
};

static double uniform(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    uint64_t mixed = *state ^ (*state >> 33);
    mixed *= UINT64_C(0xff51afd7ed558ccd);
    mixed ^= mixed >> 33;
    return (double)(mixed >> 11) * 0x1p-53;
}

static struct direction at_angle(double cosine, double azimuth) {
    const double sine = sqrt(1.0 - cosine * cosine);
    return (struct direction){sine * cos(azimuth), sine * sin(azimuth), cosine};
}

static struct direction on_plane(double radius, double azimuth) {
    return (struct direction){radius * cos(azimuth), radius * sin(azimuth), 1.0};
}

static struct direction on_surface(uint32_t i, uint32_t n) {
    const uint32_t side = (uint32_t)lround(sqrt((double)n));
    const double x = 2.0 * (i % side) / (side - 1.0) - 1.0;
    const double y = 2.0 * (i / side) / (side - 1.0) - 1.0;
    const double r = 8.0 * hypot(x, y), height = r > 0.0 ? sin(r) / r : 1.0;
    return (struct direction){x + 2.5, y + 3.5, 0.5 * height - 2.0};
}

static struct direction draw(enum bench_set set, uint32_t i, uint32_t n, uint64_t *state) {
    const double cap = M_PI / 9.0, turn = 2.0 * M_PI * uniform(state), u = uniform(state);
    switch (set) {
    case BENCH_CAP:
        return at_angle(1.0 - u * (1.0 - cos(cap)), turn);
    case BENCH_TRUNCATED_CONE: // every cross-section is a uniform disc, so depth does not matter
        return on_plane(tan(cap) * sqrt(u), turn);
    case BENCH_NORMAL:
        return on_plane(0.1 * sqrt(-2.0 * log(1.0 - u)), turn);
    case BENCH_SILHOUETTE:
        return i < 12 ? on_plane(tan(cap) * (0.9 + 0.1 * u), M_PI / 6.0 * i)
                      : on_plane(0.5 * tan(cap) * sqrt(u), turn);
    case BENCH_CIRCLE:
        return at_angle(cos(cap), turn);
    case BENCH_HALF_CIRCLE:
        return at_angle(cos(cap), M_PI * u);
    case BENCH_NEAR_HEMISPHERE:
        return at_angle(1.0 - u * (1.0 - cos(89.9 / 180.0 * M_PI)), turn);
    case BENCH_SPIRAL:
        return at_angle(cos(cap * (i + 1.0) / n), 32.0 * M_PI * (i + 1.0) / n);
    case BENCH_SURFACE:
        return on_surface(i, n);
    default:
        return at_angle(2.0 * u - 1.0, turn);
    }
}

/// x = cos t and y = sin t with t / 2 of a rational tangent, by Euclid's formula.
static struct vec3 on_exact_circle(uint32_t i, uint32_t n) {
    const double half_turn = M_PI * (i + 0.5) / n, size = 32700.0;
    const int64_t p = lround(size * cos(half_turn)), q = lround(size * sin(half_turn));
    return vec3((int32_t)(p * p - q * q), (int32_t)(2 * p * q), (int32_t)(p * p + q * q));
}

void bench_fill(enum bench_set set, uint32_t n, uint64_t seed, struct vec3 *points) {
    uint64_t state = seed * UINT64_C(0x9e3779b97f4a7c15) + 1U;
    const struct direction z = at_angle(2.0 * uniform(&state) - 1.0, 2.0 * M_PI * uniform(&state));
    const double length = hypot(z.y, z.x);
    struct direction x = {-z.y / length, z.x / length, 0.0};
    struct direction y = {z.y * x.z - z.z * x.y, z.z * x.x - z.x * x.z, z.x * x.y - z.y * x.x};
    for (uint32_t i = 0; i < n; i++) {
        if (set == BENCH_EXACT_CIRCLE) {
            points[i] = on_exact_circle(i, n);
            continue;
        }
        struct direction d = draw(set, i, n, &state);
        if (set != BENCH_SURFACE) {
            d = (struct direction){d.x * x.x + d.y * y.x + d.z * z.x,
                                   d.x * x.y + d.y * y.y + d.z * z.y,
                                   d.x * x.z + d.y * y.z + d.z * z.z};
        }
        const double scale = 0x1p30 / sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        points[i] = vec3((int32_t)lround(d.x * scale), (int32_t)lround(d.y * scale),
                         (int32_t)lround(d.z * scale));
    }
}

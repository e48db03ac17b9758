#include "bench/levine/blocks.h"

#include "check.h"

#include <math.h>

const char *blocks_name(enum block_scene scene) {
    static const char *const names[] = {"4 cubes",  "8 cubes",  "16 cubes", "24 cubes",
                                        "32 cubes", "48 cubes", "city",     "32 at random"};
    return names[scene];
}

/// A box from a corner, in thousandths of a unit.
static void add_box(struct blocks *b, const int32_t corner[3], const int32_t size[3]) {
    const int64_t unit = BLOCK_UNIT;
    struct vec3 at = vec3((int32_t)(corner[0] * unit / 1000), (int32_t)(corner[1] * unit / 1000),
                          (int32_t)(corner[2] * unit / 1000));
    CHECK_EQ(hidden_scene_box(&b->scene, at, vec3((int32_t)(size[0] * unit / 1000), 0, 0),
                              vec3(0, (int32_t)(size[1] * unit / 1000), 0),
                              vec3(0, 0, (int32_t)(size[2] * unit / 1000))),
             SHAPE_OK);
}

static void add_lattice(struct blocks *b, int32_t nx, int32_t ny, int32_t nz, uint64_t *jitter) {
    static const int32_t one[3] = {1000, 1000, 1000};
    for (int32_t i = 0; i < nx * ny * nz; i++) {
        int32_t corner[3] = {3000 * (i % nx), 3000 * (i / nx % ny), 3000 * (i / nx / ny)};
        for (int k = 0; jitter != NULL && k < 3; k++) {
            corner[k] += (int32_t)(check_random(jitter) % 1999U) - 999;
        }
        add_box(b, corner, one);
    }
}

/// Four rows of four houses at a street grid of 3; y is up. Width, depth and height of each.
static void add_city(struct blocks *b) {
    static const int32_t size[16][3] = {
        {1600, 1500, 2400}, {1800, 1900, 4200}, {1500, 1700, 1800}, {2000, 1600, 3000},
        {1900, 1500, 5400}, {1400, 1400, 7500}, {1700, 2000, 3600}, {1500, 1500, 2100},
        {2000, 1800, 1500}, {1600, 1600, 6300}, {1800, 1400, 4800}, {1400, 1900, 2700},
        {1500, 1800, 3300}, {1900, 1700, 2000}, {1600, 1500, 3900}, {1700, 1600, 1600},
    };
    for (int32_t i = 0; i < 16; i++) {
        const int32_t corner[3] = {3000 * (i % 4), 0, 3000 * (i / 4)};
        const int32_t box[3] = {size[i][0], size[i][2], size[i][1]};
        add_box(b, corner, box);
    }
}

static void measure(struct blocks *b) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double square = 0;
    for (uint32_t v = 0; v < b->scene.set.vertex_count; v++) {
        const struct vec3 p = b->scene.set.vertices[v];
        const double at[3] = {p.x, p.y, p.z};
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        b->middle[k] = (low[k] + high[k]) / 2;
        square += (high[k] - low[k]) * (high[k] - low[k]) / 4;
    }
    b->radius = sqrt(square);
}

void blocks_open(struct blocks *blocks, enum block_scene scene) {
    static const int32_t lattice[BLOCKS_COUNT][3] = {{2, 1, 2}, {2, 2, 2}, {4, 2, 2}, {4, 2, 3},
                                                     {4, 2, 4}, {4, 4, 3}, {0, 0, 0}, {4, 2, 4}};
    uint64_t jitter = 32;
    hidden_scene_open(&blocks->scene, 48);
    if (scene == BLOCKS_CITY) {
        add_city(blocks);
    } else {
        add_lattice(blocks, lattice[scene][0], lattice[scene][1], lattice[scene][2],
                    scene == BLOCKS_RANDOM ? &jitter : NULL);
    }
    measure(blocks);
}

void blocks_open_lattice(struct blocks *blocks, uint32_t side) {
    hidden_scene_open(&blocks->scene, side * side * side);
    add_lattice(blocks, (int32_t)side, (int32_t)side, (int32_t)side, NULL);
    measure(blocks);
}

void blocks_close(struct blocks *blocks) {
    hidden_scene_close(&blocks->scene);
}

static struct vec3 unit_q30(const double v[3]) {
    return vec3((int32_t)lrint(v[0] * 0x1p30), (int32_t)lrint(v[1] * 0x1p30),
                (int32_t)lrint(v[2] * 0x1p30));
}

struct hidden_camera blocks_camera_tilted(const struct blocks *blocks, double yaw, double pitch,
                                          double distance) {
    const double degree = 0.017453292519943295;
    // At whole quarter turns exactly 0 and 1, as a table of degrees has it.
    const double c = fmod(yaw + 90, 180) == 0 ? 0 : cos(yaw * degree),
                 s = fmod(yaw, 180) == 0 ? 0 : sin(yaw * degree),
                 u = fmod(pitch + 90, 180) == 0 ? 0 : cos(pitch * degree),
                 w = fmod(pitch, 180) == 0 ? 0 : sin(pitch * degree);
    const double ahead[3] = {-s * u, -w, -c * u}, right[3] = {c, 0, -s},
                 up[3] = {-s * w, u, -c * w};
    const double away = distance * blocks->radius;
    const struct vec3 eye = vec3((int32_t)lrint(blocks->middle[0] - away * ahead[0]),
                                 (int32_t)lrint(blocks->middle[1] - away * ahead[1]),
                                 (int32_t)lrint(blocks->middle[2] - away * ahead[2]));
    return (struct hidden_camera){eye, unit_q30(right), unit_q30(ahead), unit_q30(up), 0, 0};
}

struct hidden_camera blocks_camera(const struct blocks *blocks, enum block_turn turn,
                                   double degrees, double distance) {
    return blocks_camera_tilted(blocks, turn == TURN_YAW ? degrees : 0,
                                turn == TURN_PITCH ? degrees : 0, distance);
}

/// Connected components of random pictures against flood filling, and shapes whose moments are
/// known.
#include "check.h"

#include "detect/components.h"

#include <math.h>
#include <string.h>

enum { SIDE = 40 };

static uint64_t seed = UINT64_C(0xC0117);
static uint8_t picture[SIDE][SIDE];
static struct components components;

/// Floods from (u, v) with a list; marks with 0; sums up.
static struct component flood(uint8_t grid[SIDE][SIDE], uint32_t u, uint32_t v) {
    struct component found = {.left = u, .top = v, .right = u, .bottom = v};
    uint32_t list[SIDE * SIDE], count = 1;
    list[0] = v * SIDE + u;
    grid[v][u] = 0;
    while (count > 0U) {
        const uint32_t at = list[--count], x = at % SIDE, y = at / SIDE;
        found.area_px++;
        found.left = x < found.left ? x : found.left;
        found.right = x > found.right ? x : found.right;
        found.top = y < found.top ? y : found.top;
        found.bottom = y > found.bottom ? y : found.bottom;
        found.sum_u += x;
        found.sum_v += y;
        found.sum_uu += (uint64_t)x * x;
        found.sum_uv += (uint64_t)x * y;
        found.sum_vv += (uint64_t)y * y;
        for (int d = 0; d < 9; d++) {
            const int nx = (int)x + d % 3 - 1, ny = (int)y + d / 3 - 1;
            if (nx >= 0 && ny >= 0 && nx < SIDE && ny < SIDE && grid[ny][nx] != 0U) {
                grid[ny][nx] = 0;
                list[count++] = (uint32_t)(ny * SIDE + nx);
            }
        }
    }
    return found;
}

static bool same(const struct component *a, const struct component *b) {
    return a->area_px == b->area_px && a->left == b->left && a->right == b->right &&
           a->top == b->top && a->bottom == b->bottom && a->sum_u == b->sum_u &&
           a->sum_v == b->sum_v && a->sum_uu == b->sum_uu && a->sum_uv == b->sum_uv &&
           a->sum_vv == b->sum_vv;
}

static void random_pictures_like_flood_filling(void) {
    check_note("seed", (int64_t)seed);
    for (int round = 0; round < 3000 && check_clean(); round++) {
        const uint32_t width = 1U + (uint32_t)(check_random(&seed) % SIDE);
        const uint32_t height = 1U + (uint32_t)(check_random(&seed) % SIDE);
        const uint8_t least = (uint8_t)(1U + check_random(&seed) % 255U);
        const uint32_t area_min = 1U + (uint32_t)(check_random(&seed) % 4U);
        uint8_t grid[SIDE][SIDE];
        memset(grid, 0, sizeof grid);
        for (uint32_t v = 0; v < height; v++) {
            for (uint32_t u = 0; u < SIDE; u++) {
                picture[v][u] = (uint8_t)check_random(&seed); // also right of the picture
                grid[v][u] = u < width && picture[v][u] >= least;
            }
        }
        const struct component_picture view = {&picture[0][0], width, height, SIDE};
        CHECK(components_find(&components, &view, least, area_min) && components.complete);
        uint32_t next = 0;
        for (uint32_t v = 0; v < height; v++) {
            for (uint32_t u = 0; u < width; u++) {
                if (grid[v][u] == 0U) {
                    continue;
                }
                const struct component wanted = flood(grid, u, v);
                if (wanted.area_px >= area_min) {
                    CHECK(next < components.count && same(&components.item[next], &wanted));
                    next++;
                }
            }
        }
        CHECK_EQ(components.count, next);
    }
}

static void more_than_fit_are_told(void) {
    struct components small;
    CHECK(components_create(&small, 5, 2));
    memset(picture, 0, sizeof picture);
    const struct component_picture view = {&picture[0][0], SIDE, SIDE, SIDE};
    picture[1][1] = picture[3][5] = 9;
    CHECK(components_find(&small, &view, 9, 1) && small.count == 2U);
    picture[5][7] = 9;
    CHECK(!components_find(&small, &view, 9, 1) && small.count == 2U);
    for (int u = 0; u < SIDE; u += 2) {
        picture[7][u] = 9;
    }
    CHECK(!components_find(&small, &view, 9, 1));
    components_destroy(&small);
}

/// An ellipse of half axes 15 and 8 turned by 30 degrees; a square; a ring.
static void shapes_whose_moments_are_known(void) {
    const struct component_picture view = {&picture[0][0], SIDE, SIDE, SIDE};
    memset(picture, 0, sizeof picture);
    for (int v = 0; v < SIDE; v++) {
        for (int u = 0; u < SIDE; u++) {
            const double x = u - 19.3, y = v - 20.1, c = cos(0.5236), s = sin(0.5236);
            picture[v][u] = pow((c * x + s * y) / 15.0, 2) + pow((c * y - s * x) / 8.0, 2) < 1.0;
        }
    }
    CHECK(components_find(&components, &view, 1, 1));
    struct component_shape shape = component_shape_of(&components.item[0]);
    CHECK(fabs(shape.middle[0] - 19.3) < 0.2 && fabs(shape.middle[1] - 20.1) < 0.2);
    CHECK(fabs(shape.long_axis_px - 15.0) < 0.3 && fabs(shape.short_axis_px - 8.0) < 0.3);
    CHECK(fabs(shape.fill - 1.0) < 0.02);
    memset(picture, 0, sizeof picture);
    for (int v = 10; v < 30; v++) {
        memset(&picture[v][5], 1, 20);
    }
    CHECK(components_find(&components, &view, 1, 1));
    shape = component_shape_of(&components.item[0]);
    CHECK(fabs(shape.fill - 3.0 / 3.14159265) < 0.003);
    CHECK(shape.middle[0] == 14.5 && shape.middle[1] == 19.5);
    for (int v = 14; v < 26; v++) {
        memset(&picture[v][9], 0, 12);
    }
    CHECK(components_find(&components, &view, 1, 1));
    CHECK(component_shape_of(&components.item[0]).fill < 0.5);
}

int main(void) {
    if (!components_create(&components, SIDE * SIDE, SIDE * SIDE)) {
        return 1;
    }
    TEST(random_pictures_like_flood_filling);
    TEST(more_than_fit_are_told);
    TEST(shapes_whose_moments_are_known);
    components_destroy(&components);
    return check_finish();
}

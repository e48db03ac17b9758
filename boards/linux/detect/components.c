#include "detect/components.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool components_create(struct components *components, uint32_t run_capacity,
                       uint32_t component_capacity) {
    *components = (struct components){
        .run_capacity = run_capacity,
        .component_capacity = component_capacity,
        .runs = calloc(run_capacity, sizeof *components->runs),
        .item = calloc(component_capacity, sizeof *components->item),
    };
    return components->runs != NULL && components->item != NULL;
}

void components_destroy(struct components *components) {
    free(components->runs);
    free(components->item);
    memset(components, 0, sizeof *components);
}

// ---------------------------------------------------------------- runs

static uint32_t root_of(struct component_run *runs, uint32_t i) {
    while (runs[i].parent != i) {
        runs[i].parent = runs[runs[i].parent].parent;
        i = runs[i].parent;
    }
    return i;
}

/// The earlier run becomes the root, so that a root is its component's topmost run.
static void join(struct component_run *runs, uint32_t a, uint32_t b) {
    const uint32_t x = root_of(runs, a), y = root_of(runs, b);
    if (x < y) {
        runs[y].parent = x;
    } else {
        runs[x].parent = y;
    }
}

/// Eight pixels at a time where none is bright enough: most of most pictures.
static uint32_t skip_dark(const uint8_t *row, uint32_t u, uint32_t width, uint8_t least) {
    while (u + 8U <= width) {
        uint8_t most = row[u];
        for (uint32_t i = 1; i < 8U; i++) {
            most = row[u + i] > most ? row[u + i] : most;
        }
        if (most >= least) {
            break;
        }
        u += 8U;
    }
    while (u < width && row[u] < least) {
        u++;
    }
    return u;
}

/// Joins a row's runs [begin, end) with those of the row above, [above, begin).
static void join_rows(struct component_run *runs, uint32_t above, uint32_t begin, uint32_t end) {
    uint32_t a = above;
    for (uint32_t b = begin; b < end; b++) {
        while (a < begin && runs[a].right + 1U < runs[b].left) {
            a++;
        }
        for (uint32_t i = a; i < begin && runs[i].left <= runs[b].right + 1U; i++) {
            join(runs, i, b);
        }
    }
}

/// Returns how many there are; *complete: whether all fit.
static uint32_t find_runs(struct components *components, const struct component_picture *picture,
                          uint8_t least, bool *complete) {
    struct component_run *runs = components->runs;
    uint32_t count = 0, above = 0;
    for (uint32_t v = 0; v < picture->height_px; v++) {
        const uint8_t *row = picture->luma + (size_t)v * picture->stride_bytes;
        const uint32_t begin = count;
        uint32_t u = skip_dark(row, 0, picture->width_px, least);
        while (u < picture->width_px) {
            if (count == components->run_capacity) {
                *complete = false;
                return begin;
            }
            const uint32_t left = u;
            while (u < picture->width_px && row[u] >= least) {
                u++;
            }
            runs[count] = (struct component_run){left, u - 1U, v, count, 0};
            count++;
            u = skip_dark(row, u, picture->width_px, least);
        }
        join_rows(runs, above, begin, count);
        above = begin;
    }
    return count;
}

// ---------------------------------------------------------------- sums

/// 0 + 1 + ... + n and the squares.
static uint64_t sum_to(uint64_t n) {
    return n * (n + 1U) / 2U;
}

static uint64_t squares_to(uint64_t n) {
    return n * (n + 1U) * (2U * n + 1U) / 6U;
}

static void add_run(struct component *to, const struct component_run *run) {
    const uint64_t length = run->right - run->left + 1U, row = run->row;
    const uint64_t sum_u = sum_to(run->right) - sum_to(run->left) + run->left;
    const uint64_t sum_uu =
        squares_to(run->right) - squares_to(run->left) + (uint64_t)run->left * run->left;
    if (to->area_px == 0U) {
        *to = (struct component){.left = run->left, .top = run->row, .right = run->right};
    }
    to->area_px += (uint32_t)length;
    to->left = run->left < to->left ? run->left : to->left;
    to->right = run->right > to->right ? run->right : to->right;
    to->bottom = run->row;
    to->sum_u += sum_u;
    to->sum_uu += sum_uu;
    to->sum_v += length * row;
    to->sum_vv += length * row * row;
    to->sum_uv += sum_u * row;
}

bool components_find(struct components *components, const struct component_picture *picture,
                     uint8_t luma_min, uint32_t area_px_min) {
    components->complete = true;
    components->count = 0;
    struct component_run *runs = components->runs;
    const uint32_t run_count = find_runs(components, picture, luma_min, &components->complete);
    // First the areas, kept in the roots, so that small ones take no room.
    for (uint32_t i = 0; i < run_count; i++) {
        runs[root_of(runs, i)].index += runs[i].right - runs[i].left + 1U;
    }
    for (uint32_t i = 0; i < run_count; i++) {
        if (runs[i].parent != i) {
            continue;
        }
        const bool wanted = runs[i].index >= area_px_min;
        runs[i].index = UINT32_MAX;
        if (wanted && components->count == components->component_capacity) {
            components->complete = false;
        } else if (wanted) {
            memset(&components->item[components->count], 0, sizeof *components->item);
            runs[i].index = components->count++;
        }
    }
    for (uint32_t i = 0; i < run_count; i++) {
        const uint32_t index = runs[root_of(runs, i)].index;
        if (index != UINT32_MAX) {
            add_run(&components->item[index], &runs[i]);
        }
    }
    return components->complete;
}

struct component_shape component_shape_of(const struct component *component) {
    struct component_shape shape;
    const double area = component->area_px;
    const double u = (double)component->sum_u / area, v = (double)component->sum_v / area;
    // A pixel is a square, not a point: 1/12 of variance.
    const double uu = (double)component->sum_uu / area - u * u + 1.0 / 12.0;
    const double vv = (double)component->sum_vv / area - v * v + 1.0 / 12.0;
    const double uv = (double)component->sum_uv / area - u * v;
    const double mean = 0.5 * (uu + vv), half = hypot(0.5 * (uu - vv), uv);
    const double least = fmax(mean - half, 1e-3);
    shape.middle[0] = u;
    shape.middle[1] = v;
    // Half axes of a uniform ellipse are twice its standard deviations.
    shape.long_axis_px = 2.0 * sqrt(mean + half);
    shape.short_axis_px = 2.0 * sqrt(least);
    shape.fill = area / (3.14159265358979323846 * shape.long_axis_px * shape.short_axis_px);
    return shape;
}

#include "scene_cluster.h"

#include <stdlib.h>
#include <string.h>

/// Larger sets are cut between that many slices of their longest axis; smaller ones between points.
enum { SLICES = 64, SORTED_MOST = 2048 };

static int32_t coordinate(const struct cluster_point *p, int axis) {
    return axis == 0 ? p->x : axis == 1 ? p->y : p->z;
}

static void extend(struct cluster_box *box, const struct cluster_box *by) {
    for (int axis = 0; axis < 3; axis++) {
        box->low[axis] = by->low[axis] < box->low[axis] ? by->low[axis] : box->low[axis];
        box->high[axis] = by->high[axis] > box->high[axis] ? by->high[axis] : box->high[axis];
    }
}

static struct cluster_box box_of(const struct cluster_point *p) {
    return (struct cluster_box){{p->x, p->y, p->z}, {p->x, p->y, p->z}};
}

static const struct cluster_box nothing = {{INT32_MAX, INT32_MAX, INT32_MAX},
                                           {INT32_MIN, INT32_MIN, INT32_MIN}};

struct cluster_box cluster_box(const struct cluster_point *points, uint32_t count) {
    struct cluster_box box = nothing;
    for (uint32_t i = 0; i < count; i++) {
        const struct cluster_box one = box_of(&points[i]);
        extend(&box, &one);
    }
    return box;
}

/// Half the surface of a box; flat ones count, too.
static double surface(const struct cluster_box *box) {
    const double x = (double)box->high[0] - box->low[0] + 1.0,
                 y = (double)box->high[1] - box->low[1] + 1.0,
                 z = (double)box->high[2] - box->low[2] + 1.0;
    return x * y + y * z + z * x;
}

static int longest_axis(const struct cluster_box *box) {
    int axis = 0;
    for (int k = 1; k < 3; k++) {
        if ((int64_t)box->high[k] - box->low[k] > (int64_t)box->high[axis] - box->low[axis]) {
            axis = k;
        }
    }
    return axis;
}

static int order(int64_t a, int64_t b) {
    return a < b ? -1 : a > b;
}

static int by_x(const void *a, const void *b) {
    const struct cluster_point *const p = a, *const q = b;
    return p->x != q->x ? order(p->x, q->x) : order(p->source, q->source);
}

static int by_y(const void *a, const void *b) {
    const struct cluster_point *const p = a, *const q = b;
    return p->y != q->y ? order(p->y, q->y) : order(p->source, q->source);
}

static int by_z(const void *a, const void *b) {
    const struct cluster_point *const p = a, *const q = b;
    return p->z != q->z ? order(p->z, q->z) : order(p->source, q->source);
}

/// Between sorted points.
static uint32_t cut_sorted(struct cluster_point *points, uint32_t count, uint32_t whole, int axis) {
    double before[SORTED_MOST];
    qsort(points, count, sizeof *points, axis == 0 ? by_x : axis == 1 ? by_y : by_z);
    struct cluster_box box = nothing;
    uint64_t weight = 0;
    for (uint32_t i = 0; i < count; i++) {
        before[i] = i == 0U ? 0.0 : surface(&box) * (double)weight;
        const struct cluster_box one = box_of(&points[i]);
        extend(&box, &one);
        weight += points[i].weight;
    }
    const uint32_t step = count <= 64U * whole ? whole : 1U;
    uint32_t best = count > step ? step : 1U;
    double least = -1.0;
    box = nothing;
    weight = 0;
    for (uint32_t i = count; i-- > 1U;) {
        const struct cluster_box one = box_of(&points[i]);
        extend(&box, &one);
        weight += points[i].weight;
        const double cost = before[i] + surface(&box) * (double)weight;
        if (i % step == 0U && (least < 0.0 || cost < least)) {
            least = cost;
            best = i;
        }
    }
    return best;
}

static uint32_t slice_of(const struct cluster_point *p, int axis, int64_t low, int64_t size) {
    return (uint32_t)(((int64_t)coordinate(p, axis) - low) * SLICES / size);
}

/// Between slices: the points are only parted, not sorted. 0: all are in one slice.
static uint32_t cut_sliced(struct cluster_point *points, uint32_t count, int axis,
                           const struct cluster_box *all) {
    struct cluster_box box[SLICES];
    uint64_t weight[SLICES] = {0};
    const int64_t low = all->low[axis], size = (int64_t)all->high[axis] - low + 1;
    for (uint32_t i = 0; i < SLICES; i++) {
        box[i] = nothing;
    }
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t slice = slice_of(&points[i], axis, low, size);
        const struct cluster_box one = box_of(&points[i]);
        extend(&box[slice], &one);
        weight[slice] += points[i].weight;
    }
    double before[SLICES];
    struct cluster_box sum = nothing;
    uint64_t part = 0;
    for (uint32_t i = 0; i < SLICES; i++) {
        before[i] = part == 0U ? -1.0 : surface(&sum) * (double)part;
        extend(&sum, &box[i]);
        part += weight[i];
    }
    uint32_t best = 0;
    double least = -1.0;
    sum = nothing;
    part = 0;
    for (uint32_t i = SLICES; i-- > 1U;) {
        extend(&sum, &box[i]);
        part += weight[i];
        const double cost = part == 0U ? -1.0 : before[i] + surface(&sum) * (double)part;
        if (before[i] >= 0.0 && part != 0U && (least < 0.0 || cost < least)) {
            least = cost;
            best = i;
        }
    }
    uint32_t cut = 0;
    for (uint32_t i = 0; i < count && best != 0U; i++) {
        if (slice_of(&points[i], axis, low, size) < best) {
            const struct cluster_point p = points[i];
            points[i] = points[cut];
            points[cut++] = p;
        }
    }
    return cut;
}

uint32_t cluster_cut(struct cluster_point *points, uint32_t count, uint32_t whole, bool even) {
    const struct cluster_box box = cluster_box(points, count);
    const int axis = longest_axis(&box);
    if (even) {
        qsort(points, count, sizeof *points, axis == 0 ? by_x : axis == 1 ? by_y : by_z);
        return count / 2U;
    }
    if (count <= SORTED_MOST) {
        return cut_sorted(points, count, whole, axis);
    }
    const uint32_t cut = cut_sliced(points, count, axis, &box);
    return cut != 0U ? cut : count / 2U; // all points are equal
}

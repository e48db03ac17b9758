#include "regular/order.h"

#include "fixed/sort.h"

int32_t order_coordinate(struct vec3 point, unsigned axis) {
    return axis % 3U == 0U ? point.x : (axis % 3U == 1U ? point.y : point.z);
}

/// What a comparison needs: `axes` axes from `first` on.
struct key {
    struct order *order;
    unsigned first, axes;
};

static bool before(const void *context, uint32_t a, uint32_t b) {
    const struct key *const key = context;
    const struct vec3 *const points = key->order->points;
    key->order->operations++;
    for (unsigned i = 0; i < key->axes; i++) {
        const int32_t of_a = order_coordinate(points[a], key->first + i);
        const int32_t of_b = order_coordinate(points[b], key->first + i);
        if (of_a != of_b) {
            return of_a < of_b;
        }
    }
    return false;
}

void order_open(struct order *order, const struct vec3 *points, uint32_t count, bool buckets,
                struct arena *arena) {
    *order = (struct order){.points = points, .count = count, .buckets = buckets};
    order->list = arena_take(arena, count, sizeof(uint32_t));
    order->spare = arena_take(arena, count, sizeof(uint32_t));
    if (buckets) {
        order->starts = arena_take(arena, (uint64_t)count + 1U, sizeof(uint32_t));
    }
}

/// A stable sort by one axis: as many buckets as points, each sorted.
static void by_buckets(struct order *order, unsigned axis) {
    const uint32_t count = order->count;
    uint32_t *const starts = order->starts;
    int32_t low = INT32_MAX, high = INT32_MIN;
    for (uint32_t i = 0; i < count; i++) {
        const int32_t value = order_coordinate(order->points[i], axis);
        low = value < low ? value : low;
        high = value > high ? value : high;
        starts[i] = 0;
    }
    starts[count] = 0;
    const uint64_t buckets_per_width = ((uint64_t)count << 32) / ((uint64_t)(high - low) + 1U);
    for (uint32_t i = 0; i < count; i++) {
        const uint64_t above =
            (uint64_t)(order_coordinate(order->points[order->list[i]], axis) - low);
        starts[(above * buckets_per_width >> 32) + 1U]++;
    }
    for (uint32_t b = 0; b < count; b++) {
        starts[b + 1U] += starts[b];
    }
    // Placing moves each start to its end, which is where the next bucket starts.
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t index = order->list[i];
        const uint64_t above = (uint64_t)(order_coordinate(order->points[index], axis) - low);
        order->spare[starts[above * buckets_per_width >> 32]++] = index;
    }
    order->operations += 3U * (uint64_t)count;
    const struct key key = {order, axis, 1};
    uint32_t from = 0;
    for (uint32_t b = 0; b < count; b++) {
        sort_indices(order->spare + from, order->list + from, starts[b] - from, before, &key);
        from = starts[b];
    }
    uint32_t *const swap = order->list;
    order->list = order->spare;
    order->spare = swap;
}

void order_by(struct order *order, unsigned first) {
    for (uint32_t i = 0; i < order->count; i++) {
        order->list[i] = i;
    }
    if (order->count < 2U) {
        return;
    }
    if (order->buckets) {
        by_buckets(order, first + 2U);
        by_buckets(order, first + 1U);
        by_buckets(order, first);
    } else {
        const struct key key = {order, first, 3};
        sort_indices(order->list, order->spare, order->count, before, &key);
    }
}

struct spread order_spread(struct order *order, unsigned axis) {
    struct spread spread = {0, 0};
    order_by(order, axis);
    for (uint32_t i = 1; i < order->count; i++) {
        const uint32_t gap = (uint32_t)order_coordinate(order->points[order->list[i]], axis) -
                             (uint32_t)order_coordinate(order->points[order->list[i - 1U]], axis);
        spread.width += gap;
        if (gap != 0U && (spread.gap == 0U || gap < spread.gap)) {
            spread.gap = gap;
        }
    }
    return spread;
}

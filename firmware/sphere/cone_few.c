#include "sphere/cone_search.h"

struct reading {
    uint32_t worst;   // the point of least depth of those that surely violate the support
    uint32_t in_band; // if there is none: how many the filter leaves open, the support's own too
};

/// This loop reads every point at every pivot.
static struct reading read_all(struct cone_search *search) {
    const struct min_norm_filter filter = search->support.filter;
    const struct vec3 *const first = search->units, *const end = first + search->count;
    const struct vec3 *worst = end;
    const int64_t outside = filter.offset - MIN_NORM_BAND;
    int64_t limit = filter.offset + MIN_NORM_BAND;
    uint32_t in_band = 0;
    for (const struct vec3 *unit = first; unit < end; unit++) {
        const int64_t dot = vec3_dot_unit(filter.normal, *unit);
        if (dot <= limit) {
            if (dot < outside) {
                limit = dot - 1;
                worst = unit;
            } else {
                in_band++;
            }
        }
    }
    search->point_reads += search->count;
    return (struct reading){worst == end ? CONE_NO_POINT : (uint32_t)(worst - first), in_band};
}

/// The point of least depth of those that violate the support, none of them surely; CONE_NO_POINT
/// if none does.
static uint32_t worst_in_band(struct cone_search *search) {
    const struct min_norm_filter filter = search->support.filter;
    int64_t limit = MIN_NORM_BAND + 1;
    uint32_t worst = CONE_NO_POINT;
    search->point_reads += search->count;
    for (uint32_t i = 0; i < search->count; i++) {
        const int64_t depth = min_norm_depth(&filter, search->units[i]);
        if (depth < limit && cone_search_violates(search, i)) {
            worst = i;
            limit = depth;
        }
    }
    return worst;
}

enum cone_outcome cone_few_pivot(struct cone_search *search) {
    enum cone_outcome outcome;
    do {
        struct reading reading = read_all(search);
        search->alone = reading.in_band <= search->support.count; // its own are in the band
        if (reading.worst == CONE_NO_POINT && !search->alone) {
            reading.worst = worst_in_band(search);
        }
        outcome = cone_search_enter(search, reading.worst, 0, search->count, 1);
    } while (outcome == CONE_GO_ON);
    search->axis_q30 = min_norm_axis(&search->support);
    return outcome;
}

/// Points well inside the support's plane can't be farthest: the band is wider than what rounding
/// the axis does.
uint32_t cone_few_farthest(struct cone_search *search) {
    struct cone_farthest farthest;
    cone_search_own(search, &farthest);
    if (search->alone) {
        return farthest.index;
    }
    const struct min_norm_filter filter = search->support.filter;
    search->point_reads += search->count;
    for (uint32_t i = 0; i < search->count; i++) {
        if (min_norm_depth(&filter, search->units[i]) <= MIN_NORM_BAND) {
            cone_farthest_add(&farthest, i);
        }
    }
    return farthest.index;
}

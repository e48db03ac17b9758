#include "sphere/cone_search.h"

bool cone_search_point(const struct cone_search *search, uint32_t index,
                       struct min_norm_point *point) {
    const struct vec3 unit = search->units[index];
    const uint64_t near = UINT64_C(1) << 32;
    const bool kept = vec3_norm2(unit) - ((UINT64_C(1) << 60) - near) <= 2U * near;
    point->index = index;
    point->given = search->points[index];
    point->unit_q30 = kept ? unit : vec3_normalise(unit);
    return kept;
}

bool cone_search_violates(struct cone_search *search, uint32_t index) {
    if (cone_search_has(search, index)) {
        return false; // its own points lie on the circle
    }
    search->point_reads += 16U * (search->read_limit != 0U); // what it costs, for those who count
    struct min_norm_point point;
    (void)cone_search_point(search, index, &point);
    return min_norm_violated_by(&search->support, &point);
}

enum cone_outcome cone_search_enter(struct cone_search *search, uint32_t worst, uint32_t from,
                                    uint32_t end, uint32_t stride) {
    struct min_norm_point point;
    if (worst == CONE_NO_POINT) {
        return CONE_FOUND;
    }
    if (!cone_search_point(search, worst, &point)) {
        bool violating = min_norm_violated_by(&search->support, &point);
        for (uint32_t i = from; !violating && i < end; i += stride) {
            (void)cone_search_point(search, i, &point);
            violating = min_norm_violated_by(&search->support, &point);
        }
        if (!violating) {
            return CONE_FOUND;
        }
    }
    search->surrounding = point.index;
    search->pivots++;
    if (!min_norm_enter(&search->support, &point)) {
        return CONE_SURROUNDED;
    }
    return cone_search_is_over(search) ? CONE_OUT_OF_READS : CONE_GO_ON;
}

void cone_search_own(const struct cone_search *search, struct cone_farthest *farthest) {
    const struct min_norm *const own = &search->support;
    cone_farthest_start(farthest, search->points, search->axis_q30, own->point[0].index);
    for (uint8_t i = 1; i < own->count; i++) {
        cone_farthest_add(farthest, own->point[i].index);
    }
}

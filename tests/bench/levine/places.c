#include "bench/levine/places.h"

#define D    CAPS_DIMENSIONS
#define NONE UINT32_MAX

/// det[mask]: the determinant of the first rows in the columns of the mask, one row for each column
/// of it.
static void minors(uint32_t dimension, const int64_t rows[][D], uint32_t row_count,
                   wide det[1U << D]) {
    det[0] = 1;
    for (uint32_t mask = 1; mask < 1U << dimension; mask++) {
        const uint32_t row = (uint32_t)__builtin_popcount(mask) - 1U;
        det[mask] = 0;
        for (uint32_t c = 0; c < dimension && row < row_count; c++) {
            if ((mask >> c & 1U) != 0U) {
                const bool odd = (__builtin_popcount(mask >> (c + 1U)) & 1) != 0;
                const wide term = det[mask & ~(1U << c)] * rows[row][c];
                det[mask] += odd ? -term : term;
            }
        }
    }
}

static void differences(const struct places *p, uint32_t from, uint32_t to, int64_t row[D]) {
    for (uint32_t k = 0; k < p->dimension; k++) {
        row[k] = (int64_t)p->points[to][k] - p->points[from][k];
    }
}

void places_normal(const struct places *p, const uint32_t *vertex, wide normal[D]) {
    int64_t rows[D][D];
    wide det[1U << D];
    for (uint32_t i = 1; i < p->dimension; i++) {
        differences(p, vertex[0], vertex[i], rows[i - 1U]);
    }
    minors(p->dimension, (const int64_t(*)[D])rows, p->dimension - 1U, det);
    const uint32_t all = (1U << p->dimension) - 1U;
    for (uint32_t k = 0; k < p->dimension; k++) {
        const wide minor = det[all & ~(1U << k)];
        normal[k] = ((k + p->dimension) & 1U) != 0U ? minor : -minor;
    }
}

int places_order(const struct places *p, uint32_t a, uint32_t b) {
    for (uint32_t k = 0; k < p->dimension; k++) {
        if (p->points[a][k] != p->points[b][k]) {
            return p->points[a][k] < p->points[b][k] ? -1 : 1;
        }
    }
    return 0;
}

uint32_t places_extremes(const struct places *p, uint32_t *list) {
    const uint32_t d = p->dimension, directions = d + (1U << (d - 1U));
    uint32_t listed = 0;
    for (uint32_t k = 0; k < 2U * directions; k++) {
        const uint32_t direction = k / 2U;
        uint32_t best = NONE;
        int64_t most = 0;
        for (uint32_t i = 0; i < p->count; i++) {
            int64_t along = 0;
            for (uint32_t a = 0; a < d; a++) {
                const bool minus = direction >= d && ((direction - d) >> a & 1U) != 0U;
                along += direction >= d   ? (minus ? -p->points[i][a] : p->points[i][a])
                         : a == direction ? p->points[i][a]
                                          : 0;
            }
            along = k % 2U == 0U ? along : -along;
            if (best == NONE || along > most || (along == most && places_order(p, i, best) > 0)) {
                best = i;
                most = along;
            }
        }
        bool known = false;
        for (uint32_t i = 0; i < listed; i++) {
            known = known || list[i] == best;
        }
        list[listed] = best;
        listed += known ? 0U : 1U;
    }
    return listed;
}

bool places_corners(const struct places *p, const uint32_t *list, uint32_t listed, uint64_t *tests,
                    uint32_t corner[D + 1U]) {
    uint32_t found = 1;
    int64_t rows[D][D];
    wide det[1U << D];
    corner[0] = list[0];
    for (uint32_t k = 1; k < listed && found < p->dimension; k++) {
        bool off = false;
        differences(p, corner[0], list[k], rows[found - 1U]);
        minors(p->dimension, (const int64_t(*)[D])rows, found, det);
        for (uint32_t mask = 0; mask < 1U << p->dimension; mask++) {
            off = off || ((uint32_t)__builtin_popcount(mask) == found && det[mask] != 0);
        }
        if (off) {
            corner[found++] = list[k];
        }
    }
    wide normal[D];
    if (found < p->dimension) {
        return false;
    }
    places_normal(p, corner, normal);
    wide most = 0;
    uint32_t best = corner[0];
    for (uint32_t i = 0; i < p->count; i++) {
        const wide height = places_height(p, normal, corner[0], i),
                   size = height < 0 ? -height : height;
        (*tests)++;
        if (size > most || (size == most && places_order(p, i, best) > 0)) {
            most = size;
            best = i;
        }
    }
    corner[p->dimension] = best;
    return most > 0;
}

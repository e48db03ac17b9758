#include "places.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/// The coordinates as written, one after the other.
struct words {
    const char *at;
};

static struct decimal next_word(struct words *words) {
    struct decimal value;
    const size_t size = strlen(words->at);
    const enum decimal_status status = decimal_read(words->at, size, &value);
    assert(status == DECIMAL_OK); // it was when the line was read
    (void)status;
    words->at += size + 1U;
    return value;
}

static void set_axis(struct vec3 *point, uint32_t axis, int64_t value) {
    *(axis == 0U ? &point->x : axis == 1U ? &point->y : &point->z) = (int32_t)value;
}

/// All coordinates * 10^shift / divisor, rounded. False: one is beyond `most`.
static bool scale(struct points *points, int32_t shift, uint64_t divisor, int32_t most) {
    struct words words = {points->place_text};
    for (uint32_t i = 0; i < 3U * points->count; i++) {
        struct decimal value = next_word(&words);
        int64_t whole;
        value.exponent += value.digit_count != 0U ? shift : 0;
        if (!decimal_scale(&value, 1, divisor, &whole) || whole > most || whole < -most) {
            return false;
        }
        set_axis(&points->directions[i / 3U], i % 3U, whole);
    }
    return true;
}

void places_finish(struct points *points, bool from_text, int32_t most) {
    points->unit = 1.0L;
    points->places_exact = true;
    int32_t lowest = INT32_MAX, highest = INT32_MIN;
    struct words words = {points->place_text};
    for (uint32_t i = 0; i < 3U * points->count && from_text; i++) {
        const struct decimal value = next_word(&words);
        const int32_t top = value.exponent + (int32_t)value.digit_count;
        if (value.digit_count != 0U) {
            lowest = value.exponent < lowest ? value.exponent : lowest;
            highest = top > highest ? top : highest;
        }
    }
    if (!from_text || points->count == 0U) {
        return;
    }
    if (lowest == INT32_MAX) { // all zero
        for (uint32_t i = 0; i < points->count; i++) {
            points->directions[i] = vec3(0, 0, 0);
        }
        return;
    }
    if (highest - lowest <= 10 && scale(points, -lowest, 1, most)) {
        points->unit = powl(10.0L, (long double)lowest);
        return;
    }
    // Ten digits before the point, then halved until they fit.
    points->places_exact = false;
    uint64_t divisor = 1;
    while (!scale(points, 10 - highest, divisor, most)) {
        divisor *= 2U;
    }
    points->unit = (long double)divisor * powl(10.0L, (long double)(highest - 10));
}

void places_spread(struct points *points, int32_t most) {
    uint64_t largest = 0;
    for (uint32_t i = 0; i < points->count; i++) {
        const struct vec3 p = points->directions[i];
        const uint64_t size[3] = {u64_abs(p.x), u64_abs(p.y), u64_abs(p.z)};
        for (int axis = 0; axis < 3; axis++) {
            largest = size[axis] > largest ? size[axis] : largest;
        }
    }
    int32_t factor = 1;
    while (largest != 0U && largest * (uint64_t)factor <= (uint64_t)most / 2U) {
        factor *= 2;
    }
    for (uint32_t i = 0; i < points->count && factor > 1; i++) {
        struct vec3 *const p = &points->directions[i];
        *p = vec3(p->x * factor, p->y * factor, p->z * factor);
    }
    points->unit /= (long double)factor;
}

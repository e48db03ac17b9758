#include "scene/fraction.h"

static bool same(struct i128 a, struct i128 b) {
    return a.lo == b.lo && a.hi == b.hi;
}

int fraction_cmp(struct fraction a, struct fraction b) {
    if (same(a.den, b.den)) {
        return i128_cmp(a.num, b.num);
    }
    const int sa = i128_sign(a.num), sb = i128_sign(b.num);
    if (sa != sb || sa == 0) {
        return sa < sb ? -1 : sa > sb;
    }
    return i256_sign(i256_sub(i256_mul(a.num, b.den), i256_mul(b.num, a.den)));
}

int64_t fraction_q62(struct fraction a) {
    struct i128 rest = a.num;
    int64_t quotient = 0;
    if (i128_cmp(a.num, a.den) >= 0) {
        return (int64_t)1 << 62;
    }
    for (unsigned i = 0; i < 62U; i++) {
        rest = i128_add(rest, rest); // below 2^97
        quotient *= 2;
        if (i128_cmp(rest, a.den) >= 0) {
            rest = i128_sub(rest, a.den);
            quotient++;
        }
    }
    return quotient;
}

void span_list_add(struct span_list *list, struct span span) {
    uint32_t first = 0;
    while (first < list->count && fraction_cmp(list->spans[first].to, span.from) < 0) {
        first++;
    }
    uint32_t end = first;
    while (end < list->count && fraction_cmp(list->spans[end].from, span.to) <= 0) {
        end++;
    }
    if (end == first) {
        for (uint32_t i = list->count; i > first; i--) {
            list->spans[i] = list->spans[i - 1U];
        }
        list->spans[first] = span;
        list->count++;
        return;
    }
    if (fraction_cmp(list->spans[first].from, span.from) < 0) {
        span.from = list->spans[first].from;
    }
    if (fraction_cmp(list->spans[end - 1U].to, span.to) > 0) {
        span.to = list->spans[end - 1U].to;
    }
    list->spans[first] = span;
    for (uint32_t i = end; i < list->count; i++) {
        list->spans[first + 1U + i - end] = list->spans[i];
    }
    list->count -= end - first - 1U;
}

bool span_list_is_full(const struct span_list *list) {
    return list->count == 1U && i128_sign(list->spans[0].from.num) == 0 &&
           i128_cmp(list->spans[0].to.num, list->spans[0].to.den) >= 0;
}

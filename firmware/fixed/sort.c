#include "fixed/sort.h"

void sort_indices(uint32_t *list, uint32_t *spare, uint32_t count, sort_before *before,
                  const void *context) {
    uint32_t *from = list, *to = spare;
    for (uint32_t width = 1; width < count; width *= 2U) {
        for (uint32_t start = 0; start < count; start += 2U * width) {
            const uint32_t middle = count - start < width ? count : start + width;
            const uint32_t end = count - middle < width ? count : middle + width;
            uint32_t left = start, right = middle;
            for (uint32_t at = start; at < end; at++) {
                const bool take_right =
                    right < end && (left >= middle || before(context, from[right], from[left]));
                to[at] = take_right ? from[right++] : from[left++];
            }
        }
        uint32_t *swap = from;
        from = to;
        to = swap;
    }
    for (uint32_t i = 0; from != list && i < count; i++) {
        list[i] = from[i];
    }
}

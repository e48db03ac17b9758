#include "utf8.h"

#include <stdbool.h>

size_t utf8_length(const char *text, size_t size) {
    const unsigned char first = (unsigned char)text[0];
    if (first < 0x80U) {
        return 1;
    }
    // The second byte's range depends on the first: this is what rules out overlong forms,
    // surrogates and values beyond the last plane.
    unsigned char low = 0x80U, high = 0xBFU;
    size_t length = 0;
    if (first >= 0xC2U && first <= 0xDFU) {
        length = 2;
    } else if (first >= 0xE0U && first <= 0xEFU) {
        length = 3;
        low = first == 0xE0U ? 0xA0U : low;
        high = first == 0xEDU ? 0x9FU : high;
    } else if (first >= 0xF0U && first <= 0xF4U) {
        length = 4;
        low = first == 0xF0U ? 0x90U : low;
        high = first == 0xF4U ? 0x8FU : high;
    }
    if (length == 0U || length > size) {
        return 0;
    }
    const unsigned char second = (unsigned char)text[1];
    bool good = second >= low && second <= high;
    for (size_t i = 2; i < length; i++) {
        good = good && ((unsigned char)text[i] & 0xC0U) == 0x80U;
    }
    return good ? length : 0;
}

/// The four memory functions that a compiler calls by itself; there is no libc.
#include "cortexm/cortexm_memory.h"

#include <stdint.h>

/// Else the compiler would recognise a loop here and replace it by a call of the function it is in.
#define AS_WRITTEN __attribute__((optimize("no-tree-loop-distribute-patterns")))

/// Words may alias whatever is copied.
typedef uint32_t __attribute__((may_alias)) word;

AS_WRITTEN void *memcpy(void *restrict to, const void *restrict from, size_t size_bytes) {
    unsigned char *out = to;
    const unsigned char *in = from;
    if ((((uintptr_t)out | (uintptr_t)in) & 3U) == 0U) {
        for (; size_bytes >= 4U; size_bytes -= 4U, out += 4, in += 4) {
            *(word *)(void *)out = *(const word *)(const void *)in;
        }
    }
    for (; size_bytes != 0U; size_bytes--) {
        *out++ = *in++;
    }
    return to;
}

AS_WRITTEN void *memmove(void *to, const void *from, size_t size_bytes) {
    unsigned char *out = to;
    const unsigned char *in = from;
    if ((uintptr_t)out <= (uintptr_t)in) {
        for (; size_bytes != 0U; size_bytes--) {
            *out++ = *in++;
        }
    } else {
        while (size_bytes != 0U) {
            size_bytes--;
            out[size_bytes] = in[size_bytes];
        }
    }
    return to;
}

AS_WRITTEN void *memset(void *to, int value, size_t size_bytes) {
    unsigned char *out = to;
    const unsigned char byte = (unsigned char)value;
    if (((uintptr_t)out & 3U) == 0U) {
        const uint32_t four = byte * UINT32_C(0x01010101);
        for (; size_bytes >= 4U; size_bytes -= 4U, out += 4) {
            *(word *)(void *)out = four;
        }
    }
    for (; size_bytes != 0U; size_bytes--) {
        *out++ = byte;
    }
    return to;
}

AS_WRITTEN int memcmp(const void *a, const void *b, size_t size_bytes) {
    const unsigned char *left = a, *right = b;
    for (; size_bytes != 0U; size_bytes--, left++, right++) {
        if (*left != *right) {
            return *left < *right ? -1 : 1;
        }
    }
    return 0;
}

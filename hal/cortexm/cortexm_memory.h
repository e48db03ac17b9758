/// As in <string.h>, which a freestanding compiler does not have.
/// Shown: tests/gate/boot.sh (an image that needs it runs).
#ifndef CORTEXM_CORTEXM_MEMORY_H
#define CORTEXM_CORTEXM_MEMORY_H

#include <stddef.h>

void *memcpy(void *restrict to, const void *restrict from, size_t size_bytes);
void *memmove(void *to, const void *from, size_t size_bytes);
void *memset(void *to, int value, size_t size_bytes);
int memcmp(const void *a, const void *b, size_t size_bytes);

#endif

/// For the contract suites on a chip, where there is no libc: hal/cortexm/cortexm_memory.c.
#ifndef MCU_HAL_STRING_H
#define MCU_HAL_STRING_H

#include "cortexm/cortexm_memory.h"

static inline size_t strlen(const char *text) {
    size_t size = 0;
    while (text[size] != '\0') {
        size++;
    }
    return size;
}

#endif

/// What clang calls for copies on Arm, beside memcpy and its like (hal/cortexm/cortexm_memory.h):
/// the names of the "Run-time ABI for the Arm Architecture", section 4.3.4.
#include "cortexm/cortexm_memory.h"

void __aeabi_memset(void *to, size_t size_bytes, int value);
void __aeabi_memclr(void *to, size_t size_bytes);
void __aeabi_memcpy(void *to, const void *from, size_t size_bytes);
void __aeabi_memmove(void *to, const void *from, size_t size_bytes);

void __aeabi_memset(void *to, size_t size_bytes, int value) {
    (void)memset(to, value, size_bytes);
}

void __aeabi_memclr(void *to, size_t size_bytes) {
    (void)memset(to, 0, size_bytes);
}

void __aeabi_memcpy(void *to, const void *from, size_t size_bytes) {
    (void)memcpy(to, from, size_bytes);
}

void __aeabi_memmove(void *to, const void *from, size_t size_bytes) {
    (void)memmove(to, from, size_bytes);
}

// The numbered names promise an alignment, which nothing here needs.
#define SAME(name)                                                                                 \
    __asm__(".global " #name "4, " #name "8\n"                                                     \
            ".thumb_set " #name "4, " #name "\n"                                                   \
            ".thumb_set " #name "8, " #name "\n")
SAME(__aeabi_memset);
SAME(__aeabi_memclr);
SAME(__aeabi_memcpy);
SAME(__aeabi_memmove);

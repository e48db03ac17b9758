/// Makes stores of the emulated processor about fifty times quicker.
///
/// libunicorn up to 2.1 looks at every store to see whether it changes machine code that has been
/// translated (its issues 1838 and 1970, mended in 2.1.2; Debian 12 has 2.0.1). The board's RAM is
/// mapped without the right to execute, so there is none. The library takes its own functions
/// through the dynamic linker: this one stands in front of the one that enters a page into the
/// table of translations, and marks it as written already. Where a later library has no such
/// functions, nothing happens.
#include <dlfcn.h>
#include <stddef.h>
#include <stdint.h>

#define RAM_BEGIN 0x20000000U
#define RAM_END   0x20020000U
#define CCM_BEGIN 0x10000000U
#define CCM_END   0x10010000U

// As QEMU declares them for a 32-bit target; attributes are a struct of bit fields in one word.
typedef void set_page_fn(void *cpu, uint32_t address, uint64_t physical, uint32_t attributes,
                         int protection, int mmu_index, uint32_t size_bytes);
typedef void set_dirty_fn(void *cpu, uint32_t address);

set_page_fn tlb_set_page_with_attrs_arm;

void tlb_set_page_with_attrs_arm(void *cpu, uint32_t address, uint64_t physical,
                                 uint32_t attributes, int protection, int mmu_index,
                                 uint32_t size_bytes) {
    static set_page_fn *set_page;
    static set_dirty_fn *set_dirty;
    if (set_page == NULL) {
        *(void **)&set_page = dlsym(RTLD_NEXT, "tlb_set_page_with_attrs_arm");
        *(void **)&set_dirty = dlsym(RTLD_NEXT, "tlb_set_dirty_arm");
    }
    set_page(cpu, address, physical, attributes, protection, mmu_index, size_bytes);
    const uint32_t page = address & ~UINT32_C(0x3FF);
    if (set_dirty != NULL &&
        ((page >= RAM_BEGIN && page < RAM_END) || (page >= CCM_BEGIN && page < CCM_END))) {
        set_dirty(cpu, page);
    }
}

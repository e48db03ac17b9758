/// A word at an odd address: fine for a Cortex-M4, a fault for a Cortex-M0+.
#include "check.h"

static const uint32_t words[2] = {1, 2};

static void fine(void) {
    CHECK(true);
}

int main(void) {
    TEST(fine);
    const uint8_t *volatile at =
        (const uint8_t *)words + 1; // the compiler can't know that it is odd
    const volatile uint32_t *odd = (const volatile uint32_t *)(uintptr_t)at;
    return *odd == 0U ? 1 : check_finish();
}

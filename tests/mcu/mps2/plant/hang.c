/// A loop without end.
#include "check.h"

static void fine(void) {
    CHECK(true);
}

int main(void) {
    TEST(fine);
    for (;;) {
        __asm__ volatile("");
    }
}

/// Recursion without end.
#include "check.h"

static volatile int bottom;

static int deeper(int depth) {
    volatile int here[64];
    here[0] = depth;
    return bottom != 0 ? here[0] : deeper(depth + 1) + here[0];
}

static void fine(void) {
    CHECK(true);
}

int main(void) {
    TEST(fine);
    return deeper(0);
}

/// A call to where there is no memory.
#include "check.h"

static void fine(void) {
    CHECK(true);
}

int main(void) {
    TEST(fine);
    void (*const nowhere)(void) = (void (*)(void))0xF0000001U;
    nowhere();
    return check_finish();
}

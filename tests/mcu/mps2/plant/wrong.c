/// A check that does not hold.
#include "check.h"

static void wrong(void) {
    CHECK_EQ(2 * 2, 5);
}

int main(void) {
    TEST(wrong);
    return check_finish();
}

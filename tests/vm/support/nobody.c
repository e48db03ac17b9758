#include "vm/support/nobody.h"

#include "check.h"

#include <grp.h>
#include <unistd.h>

#define NOBODY 65534

void nobody_begin(void) {
    CHECK_EQ(setgroups(0, NULL), 0);
    CHECK_EQ(setegid(NOBODY), 0);
    CHECK_EQ(seteuid(NOBODY), 0);
}

void nobody_end(void) {
    CHECK_EQ(seteuid(0), 0);
    CHECK_EQ(setegid(0), 0);
}

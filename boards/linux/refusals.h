/// A device that takes settings in the background and may refuse one: when to send it again, and
/// when to give up.
///
/// What is refused is sent again REFUSALS_AGAIN_US later, so that an axis does not stay where it
/// was without anybody knowing. A device that takes none of REFUSALS_MAX in a row is of no use; one
/// that takes some is only slow. Shown: tests/scenario/test_refusals.c.
#ifndef LINUX_REFUSALS_H
#define LINUX_REFUSALS_H

#include <stdbool.h>
#include <stdint.h>

#define REFUSALS_AGAIN_US 200000U
#define REFUSALS_MAX      10U

/// All zeros: of a device that was just opened.
struct refusals {
    uint32_t failed, taken; ///< settings, as counted when it was last looked
    uint32_t in_a_row;
    bool any;
    uint32_t last_us; ///< when something was last sent again
};

/// failed, taken: counted by the device since it was opened. now_us: wraps. True: send what is
/// wanted again, now.
bool refusals_look(struct refusals *refusals, uint32_t failed, uint32_t taken, uint32_t now_us);

bool refusals_give_up(const struct refusals *refusals);

#endif

#include "refusals.h"

bool refusals_look(struct refusals *refusals, uint32_t failed, uint32_t taken, uint32_t now_us) {
    if (taken != refusals->taken) {
        refusals->taken = taken;
        refusals->in_a_row = 0;
    }
    if (failed == refusals->failed ||
        (refusals->any && now_us - refusals->last_us < REFUSALS_AGAIN_US)) {
        return false;
    }
    refusals->failed = failed;
    refusals->any = true;
    refusals->last_us = now_us;
    refusals->in_a_row++;
    return true;
}

bool refusals_give_up(const struct refusals *refusals) {
    return refusals->in_a_row >= REFUSALS_MAX;
}

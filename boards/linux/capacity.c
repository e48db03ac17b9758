#include "capacity.h"

bool capacity_exceeded(struct capacity *capacity, const struct controller_status *status) {
    const bool refused = status->updates_rejected != capacity->rejected;
    capacity->rejected = status->updates_rejected;
    const bool first = refused && status->target_count == TARGET_CAPACITY && !capacity->told;
    capacity->told = capacity->told || first;
    return first;
}

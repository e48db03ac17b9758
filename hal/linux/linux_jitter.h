/// How late things came: a histogram of so many steps, and the latest.
/// Shown: tests/contract/linux_gpio_edges.c.
#ifndef HAL_LINUX_JITTER_H
#define HAL_LINUX_JITTER_H

#include <stdint.h>

enum { LINUX_JITTER_BUCKETS = 2000 };

/// Zero it, and set step.
struct linux_jitter {
    uint64_t step;        ///< of a bucket, in the unit of what is added
    uint64_t count, over; ///< all; those beyond the last bucket
    uint64_t max;
    uint64_t bucket[LINUX_JITTER_BUCKETS];
};

void linux_jitter_add(struct linux_jitter *jitter, uint64_t late);

/// Adds what another one of the same step has.
void linux_jitter_merge(struct linux_jitter *jitter, const struct linux_jitter *other);

/// What the given share was at most; 0 if there is nothing. per_mille: 0 to 1000.
uint64_t linux_jitter_quantile(const struct linux_jitter *jitter, unsigned per_mille);

#endif

#include "linux/linux_jitter.h"

void linux_jitter_add(struct linux_jitter *jitter, uint64_t late) {
    jitter->count++;
    jitter->max = late > jitter->max ? late : jitter->max;
    if (late / jitter->step < LINUX_JITTER_BUCKETS) {
        jitter->bucket[late / jitter->step]++;
    } else {
        jitter->over++;
    }
}

void linux_jitter_merge(struct linux_jitter *jitter, const struct linux_jitter *other) {
    jitter->count += other->count;
    jitter->over += other->over;
    jitter->max = other->max > jitter->max ? other->max : jitter->max;
    for (unsigned i = 0; i < LINUX_JITTER_BUCKETS; i++) {
        jitter->bucket[i] += other->bucket[i];
    }
}

uint64_t linux_jitter_quantile(const struct linux_jitter *jitter, unsigned per_mille) {
    const uint64_t wanted = (jitter->count * per_mille + 999U) / 1000U;
    uint64_t seen = 0;
    for (unsigned i = 0; i < LINUX_JITTER_BUCKETS && wanted > 0U; i++) {
        seen += jitter->bucket[i];
        if (seen >= wanted) {
            const uint64_t most = (uint64_t)(i + 1U) * jitter->step;
            return most < jitter->max ? most : jitter->max;
        }
    }
    return wanted > 0U ? jitter->max : 0U;
}

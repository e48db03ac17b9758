/// The indices of a ring between the program and one interrupt handler, one of which only puts and
/// the other only takes: needs no lock. The items are the owner's array, of a power of two.
/// Shown: tests/mcu/hal/suites.c (the serial port is on it).
#ifndef CORTEXM_CORTEXM_RING_H
#define CORTEXM_CORTEXM_RING_H

#include "cortexm/cortexm.h"

struct cortexm_ring {
    volatile uint32_t put, taken; ///< how many ever; wrap
};

static inline uint32_t cortexm_ring_count(const struct cortexm_ring *ring) {
    return ring->put - ring->taken;
}

/// The item is written before, and read before it is given up.
static inline void cortexm_ring_put(struct cortexm_ring *ring) {
    cortexm_barrier();
    ring->put = ring->put + 1U;
}
static inline void cortexm_ring_take(struct cortexm_ring *ring) {
    cortexm_barrier();
    ring->taken = ring->taken + 1U;
}

/// By the taker: drops what is there.
static inline void cortexm_ring_clear(struct cortexm_ring *ring) {
    ring->taken = ring->put;
}

#endif

/// The trace hash: one 64-bit number over everything that happened in a simulation. Two runs are
/// the same if and only if (but for a chance of 2^-64) their hashes are; a test compares gcc with
/// clang and one seed with itself.
///
/// Each device folds the words of its state into the number it is given and returns the new one:
/// `hash = axis_plant_hash(&pan, hash)`. Order matters. Floating-point state goes in as its raw
/// bits.
///
/// FNV-1a with 64-bit words instead of bytes, and a shift after each product: a product by an odd
/// number only carries upward, so without the shift two flips of the top bit would cancel. Not
/// for security. Cost: about 2 ns a word. Shown: tests/scenario/test_trace_hash.c.
#ifndef WORLD_TRACE_HASH_H
#define WORLD_TRACE_HASH_H

#include <stdint.h>
#include <string.h>

#define TRACE_HASH_START UINT64_C(0xCBF29CE484222325)

static inline uint64_t trace_hash_u64(uint64_t hash, uint64_t word) {
    hash = (hash ^ word) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ (hash >> 32);
}

static inline uint64_t trace_hash_f64(uint64_t hash, double value) {
    uint64_t word;
    memcpy(&word, &value, sizeof word);
    return trace_hash_u64(hash, word);
}

#endif

/// For the programs of this folder: each folds what modules answer into a number, which is the same
/// on every machine, or somebody's arithmetic differs (tests/mcu/mps2/same_bits.sh compares).
///
/// Every .c file here is a program, whose tests each end with digest_finish. A new module gets a
/// file of its own or a test in one; same_bits.sh names the modules that no program reaches.
/// Random numbers are drawn one a statement: compilers order arguments and initialisers as they
/// like.
#ifndef TESTS_MCU_DIGEST_DIGEST_H
#define TESTS_MCU_DIGEST_DIGEST_H

#include "check.h"

#include "fixed/vec3.h"

struct digest {
    uint64_t hash;
    uint64_t seed;    ///< of check_random
    uint32_t results; ///< how many numbers were folded
};

static inline struct digest digest_start(uint64_t seed) {
    return (struct digest){UINT64_C(0x9E3779B97F4A7C15), seed, 0};
}

static inline void digest_u64(struct digest *digest, uint64_t value) {
    digest->hash = (digest->hash ^ value) * UINT64_C(0xD6E8FEB86659FD93);
    digest->hash ^= digest->hash >> 32;
    digest->results++;
}

static inline void digest_i64(struct digest *digest, int64_t value) {
    digest_u64(digest, (uint64_t)value);
}

static inline void digest_vec3(struct digest *digest, struct vec3 a) {
    digest_i64(digest, a.x);
    digest_i64(digest, a.y);
    digest_i64(digest, a.z);
}

static inline void digest_vec3_i64(struct digest *digest, struct vec3_i64 a) {
    digest_i64(digest, a.x);
    digest_i64(digest, a.y);
    digest_i64(digest, a.z);
}

static inline void digest_i128(struct digest *digest, struct i128 a) {
    digest_u64(digest, a.lo);
    digest_i64(digest, a.hi);
}

/// Prints the line that is compared: `# digest NAME HASH`.
static inline void digest_finish(const struct digest *digest, const char *note) {
    CHECK(digest->results > 1000U);
    check_note(note, (int64_t)digest->hash);
}

static inline uint64_t digest_any_u64(struct digest *digest) {
    const uint64_t bits = check_random(&digest->seed);
    return bits >> check_random(&digest->seed) % 64U; // all magnitudes alike
}

static inline int64_t digest_any_i64(struct digest *digest) {
    const uint64_t size = digest_any_u64(digest);
    return (int64_t)((check_random(&digest->seed) & 1U) != 0U ? 0U - size : size);
}

static inline int32_t digest_any_i32(struct digest *digest) {
    const uint32_t bits = (uint32_t)check_random(&digest->seed);
    const int32_t value = (int32_t)((bits & INT32_MAX) >> check_random(&digest->seed) % 31U);
    return (bits >> 31) != 0U ? -value - (value == INT32_MAX) : value;
}

/// Any direction: never zero.
static inline struct vec3 digest_any_direction(struct digest *digest) {
    struct vec3 a;
    do {
        a.x = digest_any_i32(digest);
        a.y = digest_any_i32(digest);
        a.z = digest_any_i32(digest);
    } while (vec3_is_zero(a));
    return a;
}

/// 0 to below.
static inline uint32_t digest_below(struct digest *digest, uint32_t below) {
    return (uint32_t)(check_random(&digest->seed) % below);
}

#endif

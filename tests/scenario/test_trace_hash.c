/// world/trace_hash.h: what changes must show.
#include "check.h"

#include "world/trace_hash.h"

enum { WORDS = 6 };

static uint64_t hash_of(const uint64_t *words) {
    uint64_t hash = TRACE_HASH_START;
    for (unsigned i = 0; i < WORDS; i++) {
        hash = trace_hash_u64(hash, words[i]);
    }
    return hash;
}

/// Any one or two bits flipped in a sequence of words change the hash. Two bits, because in plain
/// FNV-1a on words the top bits of two words cancel.
static void one_or_two_flipped_bits_show(void) {
    uint64_t words[WORDS] = {0, 1, UINT64_MAX, 0x123456789ABCDEF0U, 0, 7};
    const uint64_t before = hash_of(words);
    for (unsigned a = 0; a < WORDS * 64U && check_clean(); a++) {
        words[a / 64U] ^= UINT64_C(1) << (a % 64U);
        CHECK(hash_of(words) != before);
        for (unsigned b = a + 1U; b < WORDS * 64U && check_clean(); b++) {
            words[b / 64U] ^= UINT64_C(1) << (b % 64U);
            CHECK(hash_of(words) != before);
            words[b / 64U] ^= UINT64_C(1) << (b % 64U);
        }
        words[a / 64U] ^= UINT64_C(1) << (a % 64U);
    }
}

static void order_shows(void) {
    const uint64_t one = trace_hash_u64(trace_hash_u64(TRACE_HASH_START, 1), 2);
    const uint64_t other = trace_hash_u64(trace_hash_u64(TRACE_HASH_START, 2), 1);
    CHECK(one != other);
}

static void a_float_is_its_bits(void) {
    const uint64_t one = trace_hash_u64(TRACE_HASH_START, UINT64_C(0x3FF0000000000000));
    CHECK(trace_hash_f64(TRACE_HASH_START, 1.0) == one);
    CHECK(trace_hash_f64(TRACE_HASH_START, 0.0) != trace_hash_f64(TRACE_HASH_START, -0.0));
}

int main(void) {
    TEST(one_or_two_flipped_bits_show);
    TEST(order_shows);
    TEST(a_float_is_its_bits);
    return check_finish();
}

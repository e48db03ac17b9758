/// link/compact: every code there and back, and what half a step means.
#include "check.h"

#include "link/compact.h"

static char buffer[8];
static struct text text;

static void write(bam32_t pan, bam32_t tilt) {
    text_begin(&text, buffer, sizeof buffer);
    compact_write(&text, pan, tilt);
    CHECK_EQ(text.size_bytes, COMPACT_CHARACTERS);
}

static bool is(const char *wanted) {
    bool same = true;
    for (unsigned i = 0; i < COMPACT_CHARACTERS; i++) {
        same = same && buffer[i] == wanted[i];
    }
    return same;
}

static void known_codes(void) {
    write(bam32(0), bam32(0));
    CHECK(is("000P00")); // tilt 0 is 2^17: 32, 0, 0
    write(bam32(BAM32_QUARTER), bam32_neg(bam32(BAM32_QUARTER)));
    CHECK(is("@00000"));
    write(bam32_neg(bam32(1U << 14)), bam32(BAM32_QUARTER));
    CHECK(is("oooooo"));
    write(bam32(UINT32_MAX), bam32(1U << 13)); // rounds to a whole turn, which is none
    CHECK(is("000P01"));
}

static void every_code(void) {
    bam32_t pan, tilt;
    for (uint32_t code = 0; code < 1U << 18; code++) {
        const bam32_t wanted_pan = bam32(code << 14);
        const bam32_t wanted_tilt = bam32((code - (1U << 17)) << 13);
        write(wanted_pan, wanted_tilt);
        if (!compact_read(buffer, &pan, &tilt) || pan.bam != wanted_pan.bam ||
            tilt.bam != wanted_tilt.bam) {
            CHECK_EQ(code, -1);
            return;
        }
    }
}

static void half_a_step(void) {
    uint64_t state = 5;
    for (uint32_t i = 0; i < 100000U; i++) {
        const bam32_t pan = bam32((uint32_t)check_random(&state));
        const int32_t up = (int32_t)(check_random(&state) >> 33) - (INT32_C(1) << 30);
        bam32_t read_pan, read_tilt;
        write(pan, bam32((uint32_t)up));
        CHECK(compact_read(buffer, &read_pan, &read_tilt));
        CHECK_NEAR(bam32_diff(read_pan, pan), 0, 1 << 13);
        const bool is_top = up > (INT32_C(1) << 30) - (1 << 13);
        CHECK_NEAR(bam32_signed(read_tilt), up, is_top ? 1 << 13 : 1 << 12);
    }
}

static void other_characters(void) {
    bam32_t pan, tilt;
    for (unsigned at = 0; at < COMPACT_CHARACTERS; at++) {
        for (unsigned c = 0; c < 256U; c++) {
            char code[] = "0o0o0o";
            code[at] = (char)c;
            CHECK_EQ(compact_read(code, &pan, &tilt), c >= '0' && c <= 'o');
        }
    }
}

int main(void) {
    TEST(known_codes);
    TEST(every_code);
    TEST(half_a_step);
    TEST(other_characters);
    return check_finish();
}

#include "link/compact.h"

#define PAN_SHIFT   14U
#define TILT_SHIFT  13U
#define TILT_OFFSET (INT32_C(1) << 17)
#define CODE_MAX    ((INT32_C(1) << 18) - 1)

static void write_code(struct text *text, uint32_t code) {
    for (unsigned shift = 18; shift != 0U; shift -= 6U) {
        text_character(text, (char)('0' + (code >> (shift - 6U) & 63U)));
    }
}

static bool read_code(const char *characters, uint32_t *code) {
    *code = 0;
    for (unsigned i = 0; i < COMPACT_CHARACTERS / 2U; i++) {
        if (characters[i] < '0' || characters[i] > 'o') {
            return false;
        }
        *code = *code << 6 | (uint32_t)(characters[i] - '0');
    }
    return true;
}

void compact_write(struct text *text, bam32_t pan, bam32_t tilt) {
    write_code(text, (pan.bam + (1U << (PAN_SHIFT - 1U))) >> PAN_SHIFT);
    // Shifted into what is not negative, so that nothing depends on how the compiler shifts.
    const uint32_t above_nadir = tilt.bam + (UINT32_C(1) << 30);
    const int32_t code = (int32_t)((above_nadir + (1U << (TILT_SHIFT - 1U))) >> TILT_SHIFT);
    write_code(text, (uint32_t)(code > CODE_MAX ? CODE_MAX : code));
}

bool compact_read(const char *characters, bam32_t *pan, bam32_t *tilt) {
    uint32_t pan_code, tilt_code;
    if (!read_code(characters, &pan_code) ||
        !read_code(characters + COMPACT_CHARACTERS / 2U, &tilt_code)) {
        return false;
    }
    *pan = bam32(pan_code << PAN_SHIFT);
    *tilt = bam32((tilt_code - (uint32_t)TILT_OFFSET) << TILT_SHIFT);
    return true;
}

/// link/checked_line: the check value, the format, and damage.
#include "check.h"

#include "link/checked_line.h"

static char buffer[CHECKED_LINE_BYTES_MAX + 8U];
static struct text text;

/// Between `$` and LF: what checked_line_read gets.
static bool reads(const char *line, uint32_t size, struct checked_line *read) {
    return checked_line_read(line, size, read);
}

static void make(uint8_t host, uint8_t sequence, char type, const char *body) {
    text_begin(&text, buffer, sizeof buffer);
    checked_line_begin(&text, host, sequence, type);
    text_string(&text, body);
    CHECK(checked_line_end(&text));
}

static void known_check_values(void) {
    // The check value of CRC-16/IBM-3740 in every list of CRCs.
    CHECK_EQ(checked_line_crc("123456789", 9), 0x29b1);
    CHECK_EQ(checked_line_crc("", 0), 0xffff);
}

/// The check value is Python's: binascii.crc_hqx(b"3f1acarm", 0xffff).
static void a_known_line(void) {
    const char *wanted = "$3f1acarm*c96c\n";
    make(0x3f, 0x1a, 'c', "arm");
    for (uint32_t i = 0; wanted[i] != '\0'; i++) {
        CHECK_EQ(buffer[i], wanted[i]);
    }
    CHECK_EQ(text.size_bytes, 3U + CHECKED_LINE_BYTES_AROUND);
    CHECK_EQ(buffer[text.size_bytes - 1U], '\n');
    struct checked_line line;
    CHECK(reads(buffer + 1, text.size_bytes - 2U, &line));
    CHECK(line.host == 0x3f && line.sequence == 0x1a && line.type == 'c');
    CHECK(word_is(line.body, "arm"));
}

static void the_longest_line(void) {
    char body[CHECKED_LINE_BYTES_MAX];
    const uint32_t most = CHECKED_LINE_BYTES_MAX - CHECKED_LINE_BYTES_AROUND;
    for (uint32_t i = 0; i < sizeof body; i++) {
        body[i] = 'x';
    }
    body[most] = '\0';
    make(0, 0, 't', body);
    CHECK_EQ(text.size_bytes, CHECKED_LINE_BYTES_MAX);
    struct checked_line line;
    CHECK(reads(buffer + 1, text.size_bytes - 2U, &line) && line.body.size_bytes == most);
    body[most] = 'x';
    body[most + 1U] = '\0';
    text_begin(&text, buffer, sizeof buffer);
    checked_line_begin(&text, 0, 0, 't');
    text_string(&text, body);
    CHECK(!checked_line_end(&text));
    text_begin(&text, buffer, 11);
    checked_line_begin(&text, 0, 0, 'p');
    CHECK(!checked_line_end(&text));
}

/// Every single bit, every pair of bits and every burst up to 16 bits of one line.
static void finds_damage(void) {
    struct checked_line line;
    make(0x3f, 0x1a, 't', "0a037 1.5 2 .25");
    const uint32_t bits = (text.size_bytes - 2U) * 8U;
    uint8_t *bytes = (uint8_t *)buffer + 1;
    for (uint32_t a = 0; a < bits; a++) {
        bytes[a / 8U] ^= (uint8_t)(1U << a % 8U);
        CHECK(!reads(buffer + 1, text.size_bytes - 2U, &line));
        for (uint32_t b = a + 1U; b < bits; b++) {
            bytes[b / 8U] ^= (uint8_t)(1U << b % 8U);
            if (reads(buffer + 1, text.size_bytes - 2U, &line)) {
                CHECK_EQ(a, b);
                return;
            }
            bytes[b / 8U] ^= (uint8_t)(1U << b % 8U);
        }
        bytes[a / 8U] ^= (uint8_t)(1U << a % 8U);
    }
    uint64_t state = 99;
    for (uint32_t i = 0; i < 20000U; i++) {
        const uint64_t random = check_random(&state);
        const uint32_t at = (uint32_t)(random >> 32) % (bits - 16U);
        const uint32_t burst = (uint32_t)(random & 0xFFFFU) | 1U;
        for (uint32_t b = 0; b < 16U; b++) { // most significant bit first, as the CRC goes
            const uint32_t bit = at + b;
            bytes[bit / 8U] ^= (uint8_t)((burst >> b & 1U) << (7U - bit % 8U));
        }
        CHECK(!reads(buffer + 1, text.size_bytes - 2U, &line));
        for (uint32_t b = 0; b < 16U; b++) {
            const uint32_t bit = at + b;
            bytes[bit / 8U] ^= (uint8_t)((burst >> b & 1U) << (7U - bit % 8U));
        }
    }
    CHECK(reads(buffer + 1, text.size_bytes - 2U, &line));
}

/// A right check value does not make a line of what has none of its form.
static void what_is_no_line(void) {
    static const char *const heads[] = {"3F1acx",  "3g1acx",     "3f 1cx", "3f1ac\tx", "3f1ac$x",
                                        "3f1ac*x", "3f1acx\x7f", "3f1a",   "",         "3f1ac\xe4"};
    struct checked_line line;
    for (unsigned i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        text_begin(&text, buffer, sizeof buffer);
        text_string(&text, heads[i]);
        const uint16_t crc = checked_line_crc(buffer, text.size_bytes);
        text_character(&text, '*');
        text_hex_digits(&text, crc, 4);
        CHECK(!reads(buffer, text.size_bytes, &line));
    }
    for (uint32_t size = 0; size < 10U; size++) {
        CHECK(!reads("3f1acarm*0000", size, &line));
    }
}

int main(void) {
    TEST(known_check_values);
    TEST(a_known_line);
    TEST(the_longest_line);
    TEST(finds_damage);
    TEST(what_is_no_line);
    return check_finish();
}

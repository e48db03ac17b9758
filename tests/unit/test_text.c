/// link/text: numbers at their boundaries, and a buffer that is full.
#include "check.h"

#include "link/text.h"

static char buffer[64];
static struct text text;

static bool is(const char *wanted) {
    uint32_t i = 0;
    while (wanted[i] != '\0' && i < text.size_bytes && buffer[i] == wanted[i]) {
        i++;
    }
    text.size_bytes = wanted[i] == '\0' && i == text.size_bytes ? 0 : text.size_bytes;
    return CHECK(text.size_bytes == 0U);
}

static void begin(void) {
    text_begin(&text, buffer, sizeof buffer);
}

static void unsigned_numbers(void) {
    begin();
    text_unsigned(&text, 0, 0);
    is("0");
    text_unsigned(&text, 9, 1);
    is("9");
    text_unsigned(&text, 10, 1);
    is("10");
    text_unsigned(&text, UINT32_MAX, 0);
    is("4294967295");
    text_unsigned(&text, 42, 5);
    is("   42");
}

static void hex_numbers(void) {
    begin();
    text_hex(&text, 0x0800ABCDU);
    is("0x0800abcd");
}

static void hundredths(void) {
    begin();
    text_hundredths(&text, 0, 0);
    is("0.00");
    text_hundredths(&text, 5, 0);
    is("0.05");
    text_hundredths(&text, -5, 0);
    is("-0.05");
    text_hundredths(&text, -100, 8);
    is("   -1.00");
    text_hundredths(&text, 123456, 0);
    is("1234.56");
    text_hundredths(&text, INT64_MAX, 0);
    is("21474836.47");
    text_hundredths(&text, INT64_MIN, 0);
    is("-21474836.47");
}

static void full(void) {
    text_begin(&text, buffer, 4);
    buffer[4] = '!';
    text_string(&text, "abc");
    CHECK(!text.cut);
    text_string(&text, "def");
    CHECK(text.cut && buffer[4] == '!' && text.size_bytes == 4U);
    is("abcd");
    text_begin(&text, buffer, 0);
    text_unsigned(&text, 7, 0);
    CHECK(text.cut && text.size_bytes == 0U);
}

int main(void) {
    TEST(unsigned_numbers);
    TEST(hex_numbers);
    TEST(hundredths);
    TEST(full);
    return check_finish();
}

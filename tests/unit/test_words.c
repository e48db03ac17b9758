/// link/words: names and numbers at their boundaries.
#include "check.h"

#include "link/words.h"

static struct word word_of(const char *text) {
    struct word word = {text, 0};
    while (text[word.size_bytes] != '\0') {
        word.size_bytes++;
    }
    return word;
}

static bool decimal_is(const char *text, unsigned digits, int64_t most, int64_t wanted) {
    int64_t value;
    return word_decimal(word_of(text), digits, most, &value) && CHECK_EQ(value, wanted);
}

static bool no_decimal(const char *text, unsigned digits, int64_t most) {
    int64_t value = 7;
    return !word_decimal(word_of(text), digits, most, &value) && CHECK_EQ(value, 0);
}

static void words_are_apart_by_blanks(void) {
    struct words words = words_of("  ab  c ", 8);
    struct word word;
    CHECK(!words_at_end(&words));
    CHECK(words_next(&words, &word) && word_is(word, "ab") && !word_is(word, "a"));
    CHECK(!word_is(word, "abc"));
    CHECK(words_next(&words, &word) && word_is(word, "c"));
    CHECK(words_at_end(&words) && !words_next(&words, &word) && word.size_bytes == 0U);
    words = words_of("", 0);
    CHECK(words_at_end(&words));
}

static void decimals(void) {
    CHECK(decimal_is("0", 0, 0, 0));
    CHECK(decimal_is("-0", 3, 0, 0));
    CHECK(decimal_is("1", 3, 1000, 1000));
    CHECK(decimal_is("-1.5", 3, 2000, -1500));
    CHECK(decimal_is("+.25", 2, 100, 25));
    CHECK(decimal_is("7.", 1, 70, 70));
    CHECK(decimal_is("0.000000001", 9, 1, 1));
    CHECK(decimal_is("00000000000000000000000000001", 0, 1, 1));
    CHECK(decimal_is("4503599627.370496", 6, INT64_C(1) << 52, INT64_C(1) << 52));
    CHECK(decimal_is("100000000.000000000", 9, INT64_C(100000000000000000),
                     INT64_C(100000000000000000)));
}

static void what_is_no_decimal(void) {
    static const char *const none[] = {"",    ".",   "-",    "+",     "-.",    "1e3",
                                       "nan", "inf", "0x1",  "1,5",   "1.2.3", "--1",
                                       "+-1", "1-",  "\xff", "1.2345"};
    for (unsigned i = 0; i < sizeof none / sizeof none[0]; i++) {
        CHECK(no_decimal(none[i], 3, 1000000));
    }
    CHECK(no_decimal("1.001", 3, 1000));
    CHECK(no_decimal("-1.001", 3, 1000));
    CHECK(no_decimal("99999999999999999999999999", 0, INT64_C(100000000000000000)));
    CHECK(no_decimal("100000000000000001", 0, INT64_C(100000000000000000)));
}

static void unsigned_numbers(void) {
    uint32_t value;
    CHECK(word_unsigned(word_of("4294967295"), UINT32_MAX, &value) && value == UINT32_MAX);
    CHECK(!word_unsigned(word_of("4294967296"), UINT32_MAX, &value) && value == 0U);
    static const char *const none[] = {"", "-1", "+1", "1.", ".1", "1.0", " 1", "a"};
    for (unsigned i = 0; i < sizeof none / sizeof none[0]; i++) {
        CHECK(!word_unsigned(word_of(none[i]), UINT32_MAX, &value));
    }
}

static void hexadecimal_numbers(void) {
    uint32_t value;
    CHECK(word_hex(word_of("0f"), 2, &value) && value == 15U);
    CHECK(word_hex(word_of("ffffffff"), 8, &value) && value == UINT32_MAX);
    static const char *const none[] = {"", "f", "0F", "fff", "g0", "-1", " 1", "0x"};
    for (unsigned i = 0; i < sizeof none / sizeof none[0]; i++) {
        CHECK(!word_hex(word_of(none[i]), 2, &value) && value == 0U);
    }
}

int main(void) {
    TEST(words_are_apart_by_blanks);
    TEST(decimals);
    TEST(what_is_no_decimal);
    TEST(unsigned_numbers);
    TEST(hexadecimal_numbers);
    return check_finish();
}

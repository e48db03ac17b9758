/// The writer of JSON, the facts on top of it, and UTF-8.
#include "check.h"

#include "facts.h"
#include "utf8.h"

#include <stdlib.h>
#include <string.h>

struct page {
    FILE *stream;
    char *text;
    size_t size;
};

static void page_start(struct page *page) {
    page->stream = open_memstream(&page->text, &page->size);
}

static void page_is(struct page *page, const char *wanted) {
    fclose(page->stream);
    if (!CHECK(strcmp(page->text, wanted) == 0)) {
        printf("  got:    %s\n  wanted: %s\n", page->text, wanted);
    }
    free(page->text);
}

static void nesting_and_commas(void) {
    struct page page;
    struct json json;
    page_start(&page);
    json_start(&json, page.stream);
    json_begin_object(&json);
    json_key(&json, "a");
    json_begin_array(&json);
    json_end_array(&json);
    json_key(&json, "b");
    json_begin_array(&json);
    json_i64(&json, INT64_MIN);
    json_begin_object(&json);
    json_end_object(&json);
    json_begin_object(&json);
    json_key(&json, "c");
    json_u64(&json, UINT64_MAX);
    json_key(&json, "d");
    json_null(&json);
    json_end_object(&json);
    json_bool(&json, false);
    json_end_array(&json);
    json_key(&json, "e");
    json_number(&json, "1.50");
    json_end_object(&json);
    page_is(&page, "{\"a\": [], \"b\": [-9223372036854775808, {}, "
                   "{\"c\": 18446744073709551615, \"d\": null}, false], \"e\": 1.50}");
}

static void strings(void) {
    static const struct {
        const char *text, *json;
    } cases[] = {
        {"", "\"\""},
        {"plain", "\"plain\""},
        {"a\"b\\c", "\"a\\\"b\\\\c\""},
        {"\n\t\x01\x7f", "\"\\u000a\\u0009\\u0001\\u007f\""},
        {"\xc3\x84 \xe2\x82\xac \xf0\x9f\x98\x80", "\"\xc3\x84 \xe2\x82\xac \xf0\x9f\x98\x80\""},
        {"\xff", "\"\\ufffd\""},
        {"x\xc3", "\"x\\ufffd\""},                     // cut short
        {"\xed\xa0\x80", "\"\\ufffd\\ufffd\\ufffd\""}, // a surrogate
        {"\xc0\xaf", "\"\\ufffd\\ufffd\""},            // overlong
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct page page;
        struct json json;
        page_start(&page);
        json_start(&json, page.stream);
        json_text(&json, cases[i].text);
        page_is(&page, cases[i].json);
    }
}

/// The table of well-formed sequences (Unicode 15, table 3-7) walked over all first two bytes, with
/// good continuations behind them.
static void utf8_first_two_bytes(void) {
    int good = 0;
    for (int first = 0; first < 256; first++) {
        for (int second = 0; second < 256; second++) {
            const char text[4] = {(char)first, (char)second, '\x80', '\xBF'};
            const size_t length = utf8_length(text, 4);
            // The code point that a lenient reader would see, and how long it had to be.
            const long bits2 = second & 0x3F;
            const bool continues = (second & 0xC0) == 0x80;
            size_t wanted = 0;
            if (first < 0x80) {
                wanted = 1;
            } else if ((first & 0xE0) == 0xC0 && continues) {
                wanted = ((first & 0x1F) << 6 | bits2) >= 0x80 ? 2 : 0;
            } else if ((first & 0xF0) == 0xE0 && continues) {
                const long point = (first & 0x0FL) << 12 | bits2 << 6;
                wanted = point >= 0x800 && (point < 0xD800 || point > 0xDFFF) ? 3 : 0;
            } else if ((first & 0xF8) == 0xF0 && continues) {
                const long point = (first & 0x07L) << 18 | bits2 << 12 | 0x3F;
                wanted = point >= 0x10000 && point <= 0x10FFFF ? 4 : 0;
            }
            CHECK_EQ(length, wanted);
            good += length > 1U ? 1 : 0;
            CHECK_EQ(length > 1U ? utf8_length(text, length - 1U) : 0U, 0); // cut short
        }
    }
    CHECK_EQ(good, 30 * 64 + 32 + 12 * 64 + 32 + 2 * 64 + 48 + 3 * 64 + 16);
}

static void write_facts(struct facts *facts) {
    const uint32_t indices[2] = {7, 4294967295};
    facts_bool(facts, "flag", true);
    facts_u64(facts, "number", UINT64_MAX);
    facts_text(facts, "word", "a\"b");
    facts_significant(facts, "digits", 1.0 / 3, 12);
    facts_fixed(facts, "places", -0.5, 3);
    facts_trillionths(facts, "exact", UINT64_C(90000000000007));
    facts_null(facts, "nothing", "why");
    facts_vec3(facts, "vector", vec3(-1, 0, 2147483647));
    facts_indices(facts, "indices", indices, 2, NULL, NULL);
    facts_indices(facts, "empty", NULL, 0, NULL, NULL);
    facts_end(facts);
}

static void facts_in_both_forms(void) {
    struct page page;
    struct facts facts;
    page_start(&page);
    facts_begin(&facts, page.stream, true);
    write_facts(&facts);
    page_is(&page, "{\"flag\": true, \"number\": 18446744073709551615, \"word\": \"a\\\"b\", "
                   "\"digits\": 0.333333333333, \"places\": -0.500, \"exact\": 90.000000000007, "
                   "\"nothing\": null, \"vector\": [-1, 0, 2147483647], "
                   "\"indices\": [7, 4294967295], \"empty\": []}\n");
    page_start(&page);
    facts_begin(&facts, page.stream, false);
    write_facts(&facts);
    page_is(&page, "flag              yes\n"
                   "number            18446744073709551615\n"
                   "word              a\"b\n"
                   "digits            0.333333333333\n"
                   "places            -0.500\n"
                   "exact             90.000000000007\n"
                   "nothing           none: why\n"
                   "vector            -1 0 2147483647\n"
                   "indices           7 4294967295\n"
                   "empty             none\n");
}

int main(void) {
    TEST(nesting_and_commas);
    TEST(strings);
    TEST(utf8_first_two_bytes);
    TEST(facts_in_both_forms);
    return check_finish();
}

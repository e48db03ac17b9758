#include "property/support/xml.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum { DEPTH_MAX = 64, ID_MAX = 4000, ATTRIBUTE_MAX = 24 };

struct span {
    const char *text;
    size_t size;
};

struct parser {
    const char *text;
    size_t size, at;
    const char *wrong;
    struct span open[DEPTH_MAX];
    int depth, svg_depth, root_count;
    struct span id[ID_MAX], reference[ID_MAX];
    int id_count, reference_count;
};

static bool same(struct span a, struct span b) {
    return a.size == b.size && memcmp(a.text, b.text, a.size) == 0;
}

static bool is(struct span a, const char *word) {
    return a.size == strlen(word) && memcmp(a.text, word, a.size) == 0;
}

static bool fail(struct parser *p, const char *wrong) {
    if (p->wrong == NULL) {
        p->wrong = wrong;
    }
    return false;
}

static int peek(const struct parser *p, size_t ahead) {
    return p->at + ahead < p->size ? (unsigned char)p->text[p->at + ahead] : -1;
}

static bool take(struct parser *p, const char *word) {
    size_t size = strlen(word);
    if (p->size - p->at < size || memcmp(p->text + p->at, word, size) != 0) {
        return false;
    }
    p->at += size;
    return true;
}

static bool is_name(int c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_' || c == ':';
}

static struct span name(struct parser *p) {
    size_t start = p->at;
    while (is_name(peek(p, 0))) {
        p->at++;
    }
    return (struct span){p->text + start, p->at - start};
}

static void blanks(struct parser *p) {
    while (peek(p, 0) == ' ' || peek(p, 0) == '\n') {
        p->at++;
    }
}

/// One character of UTF-8, decoded and judged by its code point.
static bool character(struct parser *p) {
    int first = peek(p, 0);
    int more = first < 0x80 ? 0 : first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : first >= 0xC0 ? 1 : -1;
    if (more < 0 || first > 0xF7) {
        return fail(p, "a byte that begins no character");
    }
    uint32_t code = more == 0 ? (uint32_t)first : (uint32_t)first & (0x3FU >> more);
    for (int i = 1; i <= more; i++) {
        int next = peek(p, (size_t)i);
        if (next < 0x80 || next > 0xBF) {
            return fail(p, "a character that breaks off");
        }
        code = code << 6 | ((uint32_t)next & 0x3FU);
    }
    static const uint32_t least[] = {0, 0x80, 0x800, 0x10000};
    if (code < least[more] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000)) {
        return fail(p, "a character in a form that is not allowed");
    }
    if ((code < 0x20 && code != '\n') || code == 0x7F || code == 0xFFFE || code == 0xFFFF) {
        return fail(p, "a control character");
    }
    p->at += (size_t)more + 1;
    return true;
}

static bool entity(struct parser *p) {
    static const char *const known[] = {"&amp;", "&lt;", "&gt;", "&quot;"};
    for (unsigned i = 0; i < sizeof known / sizeof *known; i++) {
        if (take(p, known[i])) {
            return true;
        }
    }
    if (!take(p, "&#")) {
        return fail(p, "an & that begins no known entity");
    }
    size_t digits = 0;
    while (peek(p, 0) >= '0' && peek(p, 0) <= '9') {
        p->at++;
        digits++;
    }
    return (digits > 0 && take(p, ";")) || fail(p, "a numeric entity that breaks off");
}

/// Text up to `end`, which stays.
static bool content(struct parser *p, int end) {
    while (peek(p, 0) != end) {
        int c = peek(p, 0);
        if (c < 0) {
            return end == '<' || fail(p, "an attribute without end");
        }
        if (c == '<') {
            return fail(p, "a < in an attribute");
        }
        if (!(c == '&' ? entity(p) : character(p))) {
            return false;
        }
    }
    return true;
}

static bool attribute(struct parser *p, struct span *key) {
    *key = name(p);
    if (key->size == 0 || !take(p, "=\"")) {
        return fail(p, "an attribute that is not name=\"value\"");
    }
    struct span value = {p->text + p->at, 0};
    if (!content(p, '"')) {
        return false;
    }
    value.size = (size_t)(p->text + p->at - value.text);
    p->at++;
    if (is(*key, "id")) {
        for (int i = 0; i < p->id_count; i++) {
            if (same(p->id[i], value)) {
                return fail(p, "an id that was there before");
            }
        }
        if (p->id_count < ID_MAX) {
            p->id[p->id_count++] = value;
        }
    }
    if (is(*key, "href") && value.size > 0 && value.text[0] == '#' && p->reference_count < ID_MAX) {
        p->reference[p->reference_count++] = (struct span){value.text + 1, value.size - 1};
    }
    return true;
}

static bool end_tag(struct parser *p) {
    struct span got = name(p);
    if (p->depth == 0 || !same(got, p->open[p->depth - 1])) {
        return fail(p, "an end tag of another element");
    }
    p->depth--;
    p->svg_depth -= is(got, "svg");
    return take(p, ">") || fail(p, "an end tag without >");
}

static bool start_tag(struct parser *p) {
    struct span key[ATTRIBUTE_MAX];
    int count = 0;
    struct span element = name(p);
    if (element.size == 0) {
        return fail(p, "a < that begins no tag");
    }
    p->root_count += p->depth == 0;
    while (peek(p, 0) == ' ' || peek(p, 0) == '\n') {
        blanks(p);
        if (count == ATTRIBUTE_MAX || !attribute(p, &key[count])) {
            return fail(p, "too many attributes");
        }
        for (int i = 0; i < count; i++) {
            if (same(key[i], key[count])) {
                return fail(p, "an attribute that is there twice");
            }
        }
        count++;
    }
    if (take(p, "/>")) {
        return p->svg_depth > 0 || is(element, "meta") || fail(p, "HTML does not close that way");
    }
    if (!take(p, ">")) {
        return fail(p, "a tag without >");
    }
    if (p->depth == DEPTH_MAX) {
        return fail(p, "nested too deep");
    }
    p->open[p->depth++] = element;
    p->svg_depth += is(element, "svg");
    return true;
}

const char *xml_check(const char *text, size_t size, size_t *at) {
    static struct parser parser; // too large for a stack
    struct parser *p = &parser;
    *p = (struct parser){.text = text, .size = size};
    if (take(p, "<!DOCTYPE html>")) {
        blanks(p);
    }
    while (p->wrong == NULL && p->at < p->size) {
        if (take(p, "</")) {
            end_tag(p);
        } else if (take(p, "<")) {
            start_tag(p);
        } else {
            bool blank = peek(p, 0) == '\n';
            content(p, '<');
            if (p->depth == 0 && !(blank && p->at == p->size)) {
                fail(p, "text outside the root element");
            }
        }
    }
    if (p->depth > 0 || p->root_count != 1) {
        fail(p, "not one root element with an end");
    }
    for (int i = 0; i < p->reference_count; i++) {
        bool answered = false;
        for (int j = 0; j < p->id_count; j++) {
            answered = answered || same(p->reference[i], p->id[j]);
        }
        if (!answered) {
            fail(p, "a reference to an id that is not there");
        }
    }
    *at = p->at;
    return p->wrong;
}

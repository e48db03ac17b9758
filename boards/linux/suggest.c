#include "suggest.h"

#include <stdio.h>
#include <string.h>

/// Longer words are not compared.
enum { WORD_MOST = 47 };

static size_t min(size_t a, size_t b) {
    return a < b ? a : b;
}

/// Letters to insert, delete or change to get from a to b (Levenshtein's distance).
static size_t distance(const char *a, const char *b) {
    const size_t size_a = strlen(a), size_b = strlen(b);
    size_t row[WORD_MOST + 1];
    for (size_t j = 0; j <= size_b; j++) {
        row[j] = j;
    }
    for (size_t i = 1; i <= size_a; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= size_b; j++) {
            const size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U);
            diagonal = row[j];
            row[j] = min(change, min(row[j], row[j - 1]) + 1U);
        }
    }
    return row[size_b];
}

struct suggestion suggest_start(const char *word) {
    return (struct suggestion){.word = word};
}

void suggest_offer(struct suggestion *suggestion, const char *name) {
    const size_t size = strlen(suggestion->word);
    if (size > WORD_MOST || strlen(name) > WORD_MOST) {
        return;
    }
    const size_t apart = distance(suggestion->word, name);
    const size_t allowed = min(3, strlen(name) / 3U + 1U);
    if (apart <= allowed && apart < size &&
        (suggestion->nearest == NULL || apart < suggestion->distance)) {
        suggestion->nearest = name;
        suggestion->distance = apart;
    }
}

struct suggest_tail suggest_tail(const struct suggestion *suggestion) {
    struct suggest_tail tail = {""};
    if (suggestion->nearest != NULL) {
        snprintf(tail.text, sizeof tail.text, ", did you mean '%s'?", suggestion->nearest);
    }
    return tail;
}

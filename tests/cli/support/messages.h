/// Keeps what the program says, so that a test can compare it.
#ifndef TESTS_CLI_MESSAGES_H
#define TESTS_CLI_MESSAGES_H

#include "check.h"

#include "message.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct messages {
    FILE *stream;
    char *text;
    size_t size;
};

static inline void messages_start(struct messages *messages) {
    messages->stream = open_memstream(&messages->text, &messages->size);
    message_stream(messages->stream);
}

/// Ends keeping; true if exactly the wanted text was said.
static inline bool messages_were(struct messages *messages, const char *wanted) {
    message_stream(NULL);
    fclose(messages->stream);
    const bool same = strcmp(messages->text, wanted) == 0;
    if (!same) {
        printf("  said:   %s  wanted: %s", messages->text, wanted);
    }
    free(messages->text);
    return CHECK(same);
}

/// A stream that reads text, which must outlive it.
static inline FILE *messages_input(const char *text, size_t size) {
    FILE *const stream = fmemopen((void *)(uintptr_t)text, size, "r"); // "r" does not write
    if (stream == NULL) {
        perror("fmemopen");
        exit(1);
    }
    return stream;
}

#endif

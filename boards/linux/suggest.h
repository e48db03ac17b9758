/// "Did you mean": the known name nearest to a mistyped one.
/// Shown: tests/cli/ini.c, tests/cli/usage.sh.
#ifndef LINUX_SUGGEST_H
#define LINUX_SUGGEST_H

#include <stddef.h>

/// Of names that are offered one after the other, keeps the one nearest to the word.
struct suggestion {
    const char *word;
    const char *nearest; ///< NULL while none is near enough to be meant
    size_t distance;     ///< letters to insert, delete or change
};

struct suggestion suggest_start(const char *word);
void suggest_offer(struct suggestion *suggestion, const char *name);

/// The end of a message: `, did you mean 'NAME'?`, or nothing.
struct suggest_tail {
    char text[96];
};
struct suggest_tail suggest_tail(const struct suggestion *suggestion);

#endif

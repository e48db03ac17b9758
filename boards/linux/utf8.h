/// Well-formed UTF-8, one character at a time.
/// Shown: tests/cli/json.c.
#ifndef LINUX_UTF8_H
#define LINUX_UTF8_H

#include <stddef.h>

/// Bytes of the well-formed character at the start of text (size: bytes that are left, at least 1);
/// 0 if there is none: a stray or missing continuation, an overlong form, a surrogate, or a value
/// above U+10FFFF (Unicode 15, table 3-7).
size_t utf8_length(const char *text, size_t size);

#endif

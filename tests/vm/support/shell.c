#include "vm/support/shell.h"

#include "check.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void shell(const char *format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    const int size = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (!CHECK(size > 0 && (size_t)size < sizeof line) || !CHECK_EQ(system(line), 0)) {
        printf("  command: %s\n", line);
    }
}

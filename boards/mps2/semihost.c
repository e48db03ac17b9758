#include "semihost.h"

#include "check.h"

enum operation { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_EXIT_EXTENDED = 0x20 };
enum { OPEN_WRITE = 4, APPLICATION_EXIT = 0x20026 };

static char line[256];
static uint32_t line_size;
static uint32_t output; // the handle of the emulator's standard output; 0: not open yet

/// arguments: words, as the operation asks for them.
static uint32_t request(enum operation operation, const void *arguments) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = arguments;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void flush(void) {
    if (output == 0U) {
        // This name means the console; opened for writing it is the standard output.
        static const char name[] = ":tt";
        const uint32_t open[3] = {(uint32_t)(uintptr_t)name, OPEN_WRITE, sizeof name - 1U};
        output = request(SYS_OPEN, open);
    }
    const uint32_t write[3] = {output, (uint32_t)(uintptr_t)line, line_size};
    (void)request(SYS_WRITE, write);
    line_size = 0;
}

void semihost_write(const char *text, size_t size) {
    for (size_t i = 0; i < size; i++) {
        line[line_size++] = text[i];
        if (text[i] == '\n' || line_size == sizeof line) {
            flush();
        }
    }
}

void check_write(const char *text, size_t size) {
    semihost_write(text, size);
}

_Noreturn void semihost_exit(uint32_t status) {
    if (line_size != 0U) {
        flush();
    }
    const uint32_t reason[2] = {APPLICATION_EXIT, status};
    (void)request(SYS_EXIT_EXTENDED, reason);
    for (;;) {
    }
}

#include "state_line.h"

#include <poll.h>
#include <unistd.h>

bool state_line_print(void (*write_line)(const void *context, FILE *stream), const void *context) {
    char line[1024];
    FILE *stream = fmemopen(line, sizeof line, "w");
    long size = -1;
    if (stream != NULL) {
        write_line(context, stream);
        size = ftell(stream);
        (void)fclose(stream);
    }
    // Less than PIPE_BUF: a pipe that takes anything takes all of it.
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    return size > 0 && poll(&out, 1, 0) == 1 && (out.revents & POLLOUT) != 0 &&
           write(STDOUT_FILENO, line, (size_t)size) == (ssize_t)size;
}

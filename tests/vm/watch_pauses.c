/// For the scripts: whether the machine paused. Usage: watch_pauses MS, until SIGTERM. Prints a
/// line then if it did for longer than that.
#include "vm/support/pauses.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int main(int argc, char **argv) {
    sigset_t ends;
    int number;
    if (argc != 2) {
        fprintf(stderr, "usage: watch_pauses MS\n");
        return 2;
    }
    sigemptyset(&ends);
    sigaddset(&ends, SIGTERM);
    sigprocmask(SIG_BLOCK, &ends, NULL);
    pauses_watch((uint32_t)atoi(argv[1]) * 1000U);
    sigwait(&ends, &number);
    const char *excuse = pauses_excuse();
    if (excuse != NULL) {
        puts(excuse);
    }
    return 0;
}

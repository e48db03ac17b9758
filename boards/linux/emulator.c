#include "emulator.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/// The path of boresight-mcu beside this program. False: it does not fit.
static bool find_program(char *path, size_t size) {
    static const char name[] = "boresight-mcu";
    const ssize_t length = readlink("/proc/self/exe", path, size);
    if (length <= 0 || (size_t)length >= size) {
        return false;
    }
    path[length] = '\0';
    char *file = strrchr(path, '/') + 1;
    if ((size_t)(file - path) + sizeof name > size) {
        return false;
    }
    memcpy(file, name, sizeof name);
    return true;
}

enum exit_status emulator_run_program(const char *command, int argc, char *const *argv) {
    char path[4096];
    char **arguments = calloc((size_t)argc + 3U, sizeof *arguments);
    char *word = strdup(command);
    if (arguments == NULL || word == NULL || !find_program(path, sizeof path)) {
        message_command(command, "no memory to start boresight-mcu");
        free(word);
        free(arguments);
        return EXIT_STATUS_FAILURE;
    }
    arguments[0] = path;
    arguments[1] = word;
    for (int i = 0; i < argc; i++) {
        arguments[i + 2] = argv[i];
    }
    execv(path, arguments);
    message_command(command, "--mcu needs the program %s: %s ('make emulator' builds it)", path,
                    strerror(errno));
    free(word);
    free(arguments);
    return EXIT_STATUS_DEVICE;
}

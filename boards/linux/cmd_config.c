/// `boresight config`: reads a rig file and explains every value in it, or writes it as C.
#include "command.h"
#include "rig.h"
#include "rig_c.h"

#include <stdlib.h>
#include <string.h>

struct settings {
    bool unused;
};

static enum exit_status run(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    const char *operands[2];
    size_t count;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      operands, 2, &count)) {
        return EXIT_STATUS_USAGE;
    }
    const bool as_c = count == 2U && strcmp(operands[0], "c") == 0;
    if (count != 2U || (!as_c && strcmp(operands[0], "check") != 0)) {
        message_command(command->name,
                        "usage: boresight config check RIG.ini, or boresight config c RIG.ini");
        return EXIT_STATUS_USAGE;
    }
    struct rig *rig = malloc(sizeof *rig);
    if (rig == NULL) {
        message_command(command->name, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    enum exit_status status = rig_read(operands[1], 0, rig);
    if (status == EXIT_STATUS_OK && as_c && !rig_fits_board(rig)) {
        status = EXIT_STATUS_USAGE;
    }
    if (status == EXIT_STATUS_OK && as_c) {
        rig_write_c(rig, operands[1], stdout);
    } else if (status == EXIT_STATUS_OK) {
        rig_explain(rig, stdout);
    }
    rig_free(rig);
    free(rig);
    return status;
}

const struct command command_config = {
    .name = "config",
    .summary = "check a rig file and explain every value in it, or write it as C",
    .operands = "check|c RIG.ini",
    .help = "Reads a rig file, defaults included, as `boresight run` would. Each fault is one line "
            "that\n"
            "names the file and its line; exit status 2.\n"
            "c: writes the settings as C, for the image of a microcontroller board.\n",
    .options = NULL,
    .option_count = 0,
    .run = run,
};

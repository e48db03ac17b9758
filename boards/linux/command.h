/// The commands of the program: a table that main, `help` and the tests read.
/// Shown: tests/cli/usage.sh.
#ifndef LINUX_COMMAND_H
#define LINUX_COMMAND_H

#include "message.h"
#include "options.h"

struct command {
    const char *name;
    const char *summary;  ///< one line for `boresight help`
    const char *operands; ///< for the usage line, e.g. "[FILE]"
    const char *help;     ///< what it does and prints, for `boresight help NAME`
    const struct option *options;
    size_t option_count;
    /// argc, argv: what follows the command's name. Results go to stdout, messages to stderr.
    enum exit_status (*run)(const struct command *command, int argc, char *const *argv);
};

/// All commands, in the order of the help. To add one: write cmd_NAME.c, which defines a
/// `const struct command command_NAME`, declare it below and enter it in commands.c.
extern const struct command *const commands[];
extern const size_t command_count;

extern const struct command command_aim, command_calibrate, command_config, command_detect,
    command_hull, command_pan, command_plan, command_probe, command_regular, command_run,
    command_sim, command_scene, command_solid, command_voronoi;

#endif

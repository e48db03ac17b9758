#include "command.h"

const struct command *const commands[] = {&command_aim, &command_hull};
const size_t command_count = sizeof commands / sizeof *commands;

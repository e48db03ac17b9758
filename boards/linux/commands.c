#include "command.h"

const struct command *const commands[] = {
    &command_aim,     &command_hull,  &command_pan,       &command_regular, &command_plan,
    &command_voronoi, &command_solid, &command_scene,     &command_sim,     &command_run,
    &command_detect,  &command_probe, &command_calibrate, &command_config};
const size_t command_count = sizeof commands / sizeof *commands;

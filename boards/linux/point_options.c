#include "point_options.h"

const char *const point_inputs[] = {
    [POINTS_XYZ] = "xyz", [POINTS_Q30] = "q30", [POINTS_RADEC] = "radec", NULL};

bool point_options_format(const char *command, const struct point_options *options,
                          struct points_format *out) {
    *out =
        (struct points_format){.input = (enum points_input)options->input, .named = options->named};
    if (options->viewpoint.given && out->input != POINTS_XYZ) {
        message_command(command, "--viewpoint goes with --input xyz only: %s holds directions",
                        point_inputs[options->input]);
        return false;
    }
    for (int i = 0; i < 3; i++) {
        out->viewpoint[i] = options->viewpoint.component[i];
    }
    return true;
}

const char *point_options_name_of(const void *points, uint32_t index) {
    return points_name(points, index);
}

enum exit_status point_options_run(const struct command *command, int argc, char *const *argv,
                                   void *settings, const struct point_options *options,
                                   enum exit_status (*work)(const struct command *command,
                                                            const void *settings,
                                                            const struct points *points)) {
    struct points_format format;
    const char *file = NULL;
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, settings,
                      &file, 1, &operands) ||
        !point_options_format(command->name, options, &format)) {
        return EXIT_STATUS_USAGE;
    }
    struct points points;
    enum exit_status status = points_read(file, &format, &points);
    if (status == EXIT_STATUS_OK) {
        status = work(command, settings, &points);
    }
    points_free(&points);
    return status;
}

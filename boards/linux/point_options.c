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

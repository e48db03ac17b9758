/// The options of every command that reads points.
/// Shown: tests/cli/input.sh.
#ifndef LINUX_POINT_OPTIONS_H
#define LINUX_POINT_OPTIONS_H

#include "command.h"
#include "options.h"
#include "points.h"

struct point_options {
    int input; ///< enum points_input
    bool named;
    struct triple viewpoint;
};

extern const char *const point_inputs[];

/// Their entries in a command's table; member is the struct point_options in its settings.
#define POINT_OPTIONS(settings_type, member)                                                       \
    {"--input",                                                                                    \
     "xyz|q30|radec",                                                                              \
     "what a line holds: decimals, int32 or degrees (xyz)",                                        \
     option_choice,                                                                                \
     offsetof(settings_type, member.input),                                                        \
     point_inputs},                                                                                \
        {"--named",                                                                                \
         NULL,                                                                                     \
         "a name stands before the numbers of each line",                                          \
         option_flag,                                                                              \
         offsetof(settings_type, member.named),                                                    \
         NULL},                                                                                    \
    {                                                                                              \
        "--viewpoint", "X,Y,Z", "where the viewer is, for xyz (0,0,0)", option_triple,             \
            offsetof(settings_type, member.viewpoint), NULL                                        \
    }

/// What those lines mean, for the command's help.
#define POINT_OPTIONS_HELP                                                                         \
    "FILE holds one point a line; without it, or with -, stdin is read. Columns are apart by\n"    \
    "blanks, tabs or one comma; # starts a comment; blank lines are skipped.\n"                    \
    "  --input xyz    x y z in any one unit. Decimals are read exactly, and so is the vector\n"    \
    "                 from the viewpoint to the point. Where its components, divided by their\n"   \
    "                 common divisor, fit int32, all decisions are exact for the numbers as\n"     \
    "                 written; longer ones are scaled to 31 bits and rounded, and the\n"           \
    "                 decisions hold for the rounded ones.\n"                                      \
    "  --input q30    three int32, a direction in Q1.30, used as given\n"                          \
    "  --input radec  right ascension and declination in degrees: x = cos d cos a,\n"              \
    "                 y = cos d sin a, z = sin d, rounded to 31 bits\n"                            \
    "Indices in the results count points from 0.\n"

/// The format that the options ask for. False: told on stderr what does not go together.
bool point_options_format(const char *command, const struct point_options *options,
                          struct points_format *out);

/// Runs a command that reads one file of points and has no other arguments: the options into
/// settings, of which `options` is a part, then the points, then `work` with both.
enum exit_status point_options_run(const struct command *command, int argc, char *const *argv,
                                   void *settings, const struct point_options *options,
                                   enum exit_status (*work)(const struct command *command,
                                                            const void *settings,
                                                            const struct points *points));

/// A point's name for facts_indices; context is a struct points.
const char *point_options_name_of(const void *points, uint32_t index);

#endif

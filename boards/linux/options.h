/// Command line options as a table: used to read them and to print their help.
///
/// `--name VALUE` or `--name=VALUE`, before or after the operands; `--` ends the options, and a
/// lone `-` is an operand. Of an option given twice the last counts.
/// Shown: tests/cli/usage.sh.
#ifndef LINUX_OPTIONS_H
#define LINUX_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct option {
    const char *name;  ///< with the dashes
    const char *value; ///< what the help calls the value; NULL: a flag
    const char *help;  ///< one line; the default belongs in it
    /// Reads the value into place. Returns: NULL, or what is wrong, to follow "--name 'VALUE': ".
    const char *(*read)(const struct option *option, const char *text, void *place);
    size_t offset;              ///< of the place in the command's settings
    const char *const *choices; ///< for option_choice; ends with NULL
};

/// A flag's `bool`.
const char *option_flag(const struct option *option, const char *text, void *place);
/// The text itself, a `const char *`.
const char *option_text(const struct option *option, const char *text, void *place);
/// The index of one of the option's choices, an `int`.
const char *option_choice(const struct option *option, const char *text, void *place);
/// X,Y,Z: a `struct triple`.
const char *option_triple(const struct option *option, const char *text, void *place);
/// An unsigned decimal integer, a `uint64_t`.
const char *option_u64(const struct option *option, const char *text, void *place);

/// The flag that every command with results has.
#define OPTION_JSON(settings_type)                                                                 \
    { "--json", NULL, "print one JSON object", option_flag, offsetof(settings_type, json), NULL }

/// Reads the arguments behind a command's name. settings holds the defaults already.
/// operands: at most operand_most pointers; *operand_count how many there were.
/// Returns: false after one line on stderr that names the option.
bool options_read(const char *command, const struct option *options, size_t option_count, int argc,
                  char *const *argv, void *settings, const char **operands, size_t operand_most,
                  size_t *operand_count);

/// The same with one operand: a file that is read more than once, so `-` is none. what: "rig", for
/// the question.
bool options_read_file(const char *command, const struct option *options, size_t option_count,
                       int argc, char *const *argv, void *settings, const char *what,
                       const char **file);

/// The text of an option as a decimal above 0, at most 4,000,000. False: told on stderr why not.
bool option_positive(const char *command, const char *name, const char *text, double *out);

/// The options as the help shows them, a line each.
void options_print(const struct option *options, size_t option_count);

#endif

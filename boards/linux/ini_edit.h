/// Changes values in an INI file and leaves everything else as it is, to the byte: comments, blank
/// lines, order, line ends.
///
/// A value is replaced where it stands; a key that is not there goes behind the last one of its
/// section, a section that is not there to the end. Shown: tests/cli/ini_edit.c.
#ifndef LINUX_INI_EDIT_H
#define LINUX_INI_EDIT_H

#include "ini.h"

enum { INI_CHANGE_BYTES = 160 };

struct ini_change {
    const char *section, *key;
    char value[INI_CHANGE_BYTES];
};

/// The text with the changes made. ini: of the same text. Returns the new text, ended by 0, and its
/// size in *size_out; free it. NULL: no memory.
char *ini_edit_text(const char *text, size_t size, const struct ini *ini,
                    const struct ini_change *changes, unsigned count, size_t *size_out);

/// The same in the file that ini was read from, which is replaced whole or not at all; its
/// permissions stay. Returns: EXIT_STATUS_OK, or another after a line on stderr: it can't be
/// written, or has changed since it was read.
enum exit_status ini_edit_file(const struct ini *ini, const struct ini_change *changes,
                               unsigned count);

#endif

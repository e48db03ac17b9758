/// Changes values in an INI file and leaves everything else as it is, to the byte: comments, blank
/// lines, order, line ends.
///
/// A note is a comment behind the value that begins with INI_NOTE_MARK: behind the person's own,
/// and in the place of an older note. A value is replaced where it stands; a key that is not there
/// goes behind the last one of its section, a section that is not there to the end. Shown:
/// tests/cli/ini_edit.c.
#ifndef LINUX_INI_EDIT_H
#define LINUX_INI_EDIT_H

#include "ini.h"

#include "fixed/must_check.h"

enum { INI_CHANGE_BYTES = 160, INI_NOTE_BYTES = 120 };
#define INI_NOTE_MARK "# measured "

struct ini_change {
    const char *section, *key;
    char value[INI_CHANGE_BYTES];
    char note[INI_NOTE_BYTES]; ///< what stands behind the mark; empty: none, and an older one goes
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

/// May the file be written, also by root? False: told on stderr.
bool ini_edit_allowed(const char *path) MUST_CHECK;

#endif

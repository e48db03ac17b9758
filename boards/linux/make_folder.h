/// Makes a folder and those above it.
/// Shown: tests/cli/drive.sh.
#ifndef LINUX_MAKE_FOLDER_H
#define LINUX_MAKE_FOLDER_H

#include <stdbool.h>

/// True if the folder is there afterwards; otherwise errno tells why not.
bool make_folder(const char *path);

#endif

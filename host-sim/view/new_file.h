/// A file that appears whole or not at all: written beside its place, then renamed.
#ifndef VIEW_NEW_FILE_H
#define VIEW_NEW_FILE_H

#include <stdbool.h>
#include <stddef.h>

/// Makes `path` a file of these bytes; a symbolic link is followed. False: errno tells why, no part
/// of the new file stays, and whatever stood at `path` stands there still. What is no regular file
/// (a device, a folder) is refused: the renaming would replace it.
bool new_file_write(const char *path, const void *bytes, size_t size);

#endif

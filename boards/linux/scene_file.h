/// A sphere tree in a file, mapped and checked.
/// Shown: tests/cli/scene.sh.
#ifndef LINUX_SCENE_FILE_H
#define LINUX_SCENE_FILE_H

#include "message.h"

#include "scene/tree.h"

struct scene_file {
    struct tree tree;
    void *block; ///< mapped; NULL: none
    size_t size_bytes;
};

/// Opens the file at path. A fault is told in one line with its offset. Close in any case.
enum exit_status scene_file_open(const char *path, struct scene_file *out);

void scene_file_close(struct scene_file *file);

/// Writes a block under another name and puts it in place at the end: the old file or the new one,
/// nothing half written.
enum exit_status scene_file_write(const char *path, const void *block, size_t size_bytes);

#endif

#include "scene_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *fault_of(enum tree_status status) {
    switch (status) {
    case TREE_ERROR_SIZE:
        return "is not as long as it says";
    case TREE_ERROR_FORMAT:
        return "is no sphere tree of this version";
    case TREE_ERROR_CRC:
        return "is damaged: its checksum is wrong";
    default:
        return "is no tree: an index or a value is out of place";
    }
}

enum exit_status scene_file_open(const char *path, struct scene_file *out) {
    *out = (struct scene_file){.block = NULL};
    struct stat info;
    const int handle = open(path, O_RDONLY | O_CLOEXEC);
    if (handle < 0 || fstat(handle, &info) != 0) {
        message_at(path, 0, "%s", strerror(errno));
        if (handle >= 0) {
            close(handle);
        }
        return EXIT_STATUS_USAGE;
    }
    if (!S_ISREG(info.st_mode) || info.st_size < (off_t)TREE_HEADER_BYTES) {
        message_at(path, 0, "%s",
                   S_ISREG(info.st_mode) ? "at offset 0: is too short for a sphere tree"
                                         : "is no regular file");
        close(handle);
        return EXIT_STATUS_USAGE;
    }
    void *const block = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, handle, 0);
    const int fault = errno;
    close(handle);
    if (block == MAP_FAILED) {
        message_at(path, 0, "%s", strerror(fault));
        return EXIT_STATUS_FAILURE;
    }
    out->block = block;
    out->size_bytes = (size_t)info.st_size;
    size_t offset;
    const enum tree_status status = tree_open(block, out->size_bytes, &out->tree, &offset);
    if (status != TREE_OK) {
        message_at(path, 0, "at offset %lu: %s", (unsigned long)offset, fault_of(status));
        return EXIT_STATUS_USAGE;
    }
    return EXIT_STATUS_OK;
}

void scene_file_close(struct scene_file *file) {
    if (file->block != NULL) {
        munmap(file->block, file->size_bytes);
    }
    *file = (struct scene_file){.block = NULL};
}

enum exit_status scene_file_write(const char *path, const void *block, size_t size_bytes) {
    const size_t length = strlen(path);
    char *const name = malloc(length + 5U);
    if (name == NULL) {
        message_at(path, 0, "no memory");
        return EXIT_STATUS_FAILURE;
    }
    memcpy(name, path, length);
    memcpy(name + length, ".new", 5);
    FILE *const stream = fopen(name, "wb");
    bool good = stream != NULL && fwrite(block, 1, size_bytes, stream) == size_bytes;
    int fault = errno;
    if (stream != NULL && fclose(stream) != 0 && good) {
        good = false;
        fault = errno;
    }
    if (good && rename(name, path) != 0) {
        good = false;
        fault = errno;
    }
    if (!good) {
        message_at(path, 0, "can't be written: %s", strerror(fault));
        if (stream != NULL) {
            (void)unlink(name);
        }
    }
    free(name);
    return good ? EXIT_STATUS_OK : EXIT_STATUS_USAGE;
}

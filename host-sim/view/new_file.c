#include "view/new_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// Where the file shall stand in the end: `path` without symbolic links, if there is one.
static bool find_place(const char *path, char place[PATH_MAX]) {
    struct stat there;
    if (strlen(path) >= PATH_MAX) {
        errno = ENAMETOOLONG;
        return false;
    }
    strcpy(place, path);
    if (lstat(path, &there) != 0) {
        return errno == ENOENT;
    }
    if (S_ISLNK(there.st_mode)) {
        // A link that leads nowhere is an error: what it should lead to is anyone's guess.
        if (realpath(path, place) == NULL || stat(place, &there) != 0) {
            return false;
        }
    }
    if (!S_ISREG(there.st_mode)) {
        errno = S_ISDIR(there.st_mode) ? EISDIR : EINVAL;
        return false;
    }
    return true;
}

static bool write_all(int descriptor, const char *bytes, size_t size) {
    while (size > 0) {
        ssize_t written = write(descriptor, bytes, size);
        if (written < 0 && errno != EINTR) {
            return false;
        }
        if (written > 0) {
            bytes += written;
            size -= (size_t)written;
        }
    }
    return true;
}

bool new_file_write(const char *path, const void *bytes, size_t size) {
    char place[PATH_MAX], beside[PATH_MAX];
    if (!find_place(path, place)) {
        return false;
    }
    int length = snprintf(beside, sizeof beside, "%s.%ld.new", place, (long)getpid());
    if (length < 0 || (size_t)length >= sizeof beside) {
        errno = ENAMETOOLONG;
        return false;
    }
    unlink(beside); // left over from a process of the same number that was killed
    int descriptor = open(beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) {
        return false;
    }
    // On the disk before it gets its name: a power cut must not leave an empty file there.
    bool whole = write_all(descriptor, bytes, size) &&
                 (fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS);
    int why = errno;
    if (close(descriptor) != 0 && whole) { // a disk behind a network says only now that it is full
        whole = false;
        why = errno;
    }
    if (whole && rename(beside, place) != 0) {
        whole = false;
        why = errno;
    }
    if (!whole) {
        unlink(beside);
        errno = why;
    }
    return whole;
}

#include "make_folder.h"

#include <errno.h>
#include <stdio.h>
#include <sys/stat.h>

static bool make_one(const char *path) {
    struct stat found;
    if (mkdir(path, 0777) == 0) {
        return true;
    }
    if (errno != EEXIST || stat(path, &found) != 0) {
        return false;
    }
    errno = ENOTDIR;
    return S_ISDIR(found.st_mode);
}

bool make_folder(const char *path) {
    char partial[4096];
    const int size = snprintf(partial, sizeof partial, "%s", path);
    if (size < 0 || (size_t)size >= sizeof partial) {
        errno = ENAMETOOLONG;
        return false;
    }
    for (char *at = partial + 1; *at != '\0'; at++) {
        if (*at == '/') {
            *at = '\0';
            if (!make_one(partial)) {
                return false;
            }
            *at = '/';
        }
    }
    return make_one(partial);
}

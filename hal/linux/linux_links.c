#include "linux/linux_links.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/// The link in root/folder that leads to the device, if it fits.
static bool find_link(const char *root, const char *folder, const char *device, char *link,
                      size_t size) {
    char pattern[300];
    glob_t links = {0};
    struct stat wanted, about;
    bool found = false;
    snprintf(pattern, sizeof pattern, "%.200s/%.50s/*", root, folder);
    if (stat(device, &wanted) == 0 && glob(pattern, 0, NULL, &links) == 0) {
        for (size_t i = 0; i < links.gl_pathc && !found; i++) {
            const char *at = links.gl_pathv[i];
            found = strlen(at) < size && stat(at, &about) == 0 && S_ISCHR(about.st_mode) &&
                    about.st_rdev == wanted.st_rdev;
            if (found) {
                snprintf(link, size, "%s", at);
            }
        }
    }
    globfree(&links);
    return found;
}

bool linux_links_has_id(const char *root, const char *device) {
    char link[4096];
    return find_link(root, "by-id", device, link, sizeof link);
}

void linux_links_prefer(const char *root, bool shared, char *path, size_t size) {
    if (shared || !find_link(root, "by-id", path, path, size)) {
        (void)find_link(root, "by-path", path, path, size);
    }
}

/// In place of tags.c where libapriltag is missing.
#include "detect/tags.h"

#include <string.h>

const char *tags_missing(void) {
    return "this program was built without libapriltag: install libapriltag-dev and build it again";
}

const char *tags_library(void) {
    return NULL;
}

/// A word of the list: a rig file is right or wrong with and without the library.
bool tags_family_known(const char *family) {
    static const char families[] = TAGS_FAMILIES;
    const size_t size = strlen(family);
    const char *at = strstr(families, family);
    return size > 0U && at != NULL && (at == families || at[-1] == ' ') &&
           (at[size] == ',' || at[size] == '\0');
}

struct tags *tags_create(const char *family) {
    (void)family;
    return NULL;
}

void tags_destroy(struct tags *tags) {
    (void)tags;
}

void tags_find(struct tags *tags, const struct hal_camera_luma *frame,
               const struct camera_model *model, struct detections *out) {
    (void)model;
    (void)tags;
    (void)frame;
    (void)out;
}

bool tags_draw(const char *family, uint32_t id, uint8_t texture[TAGS_CELLS_MAX * TAGS_CELLS_MAX],
               uint32_t *cells) {
    (void)family;
    (void)id;
    (void)texture;
    (void)cells;
    return false;
}

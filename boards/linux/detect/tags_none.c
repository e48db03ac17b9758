/// In place of tags.c where libapriltag is missing.
#include "detect/tags.h"

#include <string.h>

const char *tags_missing(void) {
    return "this program was built without libapriltag: install libapriltag-dev and build it again";
}

const char *tags_library(void) {
    return NULL;
}

bool tags_family_known(const char *family) {
    (void)family;
    return true; // nobody gets as far as to ask for it
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

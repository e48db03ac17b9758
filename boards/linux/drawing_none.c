/// Without cairo there is no PNG.
#include "drawing.h"

const char *drawing_png_library(void) {
    return NULL;
}

void *drawing_png(const struct drawing *drawing, size_t *size_bytes) {
    (void)drawing;
    *size_bytes = 0;
    return NULL;
}

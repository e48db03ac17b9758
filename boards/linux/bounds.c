#include "bounds.h"

#include <stdlib.h>
#include <string.h>

static bool keep(struct bounds_side *side, const char *text, size_t size) {
    char *const copy = malloc(size + 1U);
    if (copy == NULL) {
        return false;
    }
    memcpy(copy, text, size);
    copy[size] = '\0';
    free(side->text);
    side->text = copy;
    return decimal_read(copy, size, &side->value) == DECIMAL_OK;
}

bool bounds_add(struct bounds *bounds, int axis, const char *text, size_t size,
                const struct decimal *value) {
    struct bounds_side *least = &bounds->least[axis], *most = &bounds->most[axis];
    bounds->any = true;
    const bool lower = least->text == NULL || decimal_compare(value, &least->value) < 0,
               higher = most->text == NULL || decimal_compare(value, &most->value) > 0;
    return (!lower || keep(least, text, size)) && (!higher || keep(most, text, size));
}

void bounds_corner(const struct bounds *bounds, int corner, struct decimal out[3]) {
    for (int axis = 0; axis < 3; axis++) {
        out[axis] =
            (corner >> axis & 1) != 0 ? bounds->most[axis].value : bounds->least[axis].value;
    }
}

void bounds_free(struct bounds *bounds) {
    for (int axis = 0; axis < 3; axis++) {
        free(bounds->least[axis].text);
        free(bounds->most[axis].text);
    }
    *bounds = (struct bounds){0};
}

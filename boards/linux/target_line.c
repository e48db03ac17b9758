#include "target_line.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static char problem[JSON_ERROR_TEXT_LENGTH + 16];

static bool finite_number(const json_t *value, double *out) {
    if (!json_is_number(value)) {
        return false;
    }
    *out = json_number_value(value);
    return isfinite(*out);
}

static bool three_numbers(const json_t *value, double out[3]) {
    return json_is_array(value) && json_array_size(value) == 3U &&
           finite_number(json_array_get(value, 0), &out[0]) &&
           finite_number(json_array_get(value, 1), &out[1]) &&
           finite_number(json_array_get(value, 2), &out[2]);
}

static const char *read_position(const json_t *xyz, double radius_m, struct target_update *update) {
    double metres[3];
    if (!three_numbers(xyz, metres)) {
        return "\"xyz\" needs three finite numbers";
    }
    int64_t um[3];
    for (unsigned i = 0; i < 3U; i++) {
        if (fabs(metres[i]) > (double)TARGET_POSITION_UM_MAX * 1e-6) {
            return "\"xyz\" is out of range";
        }
        um[i] = llround(metres[i] * 1e6);
    }
    if (radius_m > 4000.0) {
        return "\"radius\" is more than 4,000 m";
    }
    update->kind = TARGET_POSITION;
    update->position_um = (struct vec3_i64){um[0], um[1], um[2]};
    update->radius_um = (uint32_t)llround(radius_m * 1e6);
    return NULL;
}

static const char *read_direction(const json_t *dir, double radius_deg,
                                  struct target_update *update) {
    double v[3];
    if (!three_numbers(dir, v)) {
        return "\"dir\" needs three finite numbers";
    }
    const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (largest == 0.0) {
        return "\"dir\" has no direction";
    }
    if (radius_deg >= 90.0) {
        return "\"radius\" is not below 90 degrees";
    }
    // 31 bits; frexp and ldexp scale by a power of two, so nothing is lost before the rounding.
    int exponent;
    (void)frexp(largest, &exponent);
    int32_t scaled[3];
    for (unsigned i = 0; i < 3U; i++) {
        const double value = round(ldexp(v[i], 31 - exponent));
        scaled[i] = value >= 2147483647.0    ? INT32_MAX
                    : value <= -2147483647.0 ? -INT32_MAX
                                             : (int32_t)value;
    }
    update->kind = TARGET_DIRECTION;
    update->direction = vec3(scaled[0], scaled[1], scaled[2]);
    update->radius_bam32 = (uint32_t)llround(radius_deg / 360.0 * 4294967296.0);
    return NULL;
}

static const char *read_id(const json_t *object, uint32_t *id) {
    const json_t *value = json_object_get(object, "id");
    if (!json_is_integer(value) || json_integer_value(value) < 0 ||
        json_integer_value(value) > UINT32_MAX) {
        return "\"id\" must be an integer from 0 to 4294967295";
    }
    *id = (uint32_t)json_integer_value(value);
    return NULL;
}

/// The object's number; a new name gets the next one.
static const char *read_object(const json_t *object, struct target_objects *objects,
                               uint16_t *number) {
    const json_t *value = json_object_get(object, "object");
    *number = 0;
    if (value == NULL) {
        return NULL;
    }
    const char *name = json_string_value(value);
    if (name == NULL || strlen(name) >= sizeof objects->name[0]) {
        return "\"object\" must be a name of at most 31 letters";
    }
    const uint32_t most = sizeof objects->name / sizeof objects->name[0];
    for (uint32_t i = 0; i < objects->count; i++) {
        if (strcmp(objects->name[i], name) == 0) {
            *number = (uint16_t)(i + 1U);
            return NULL;
        }
    }
    if (objects->count == most) {
        return "more than 64 different objects";
    }
    memcpy(objects->name[objects->count], name, strlen(name) + 1U);
    *number = (uint16_t)++objects->count;
    return NULL;
}

/// A number in [0, infinity), or its default.
static const char *read_amount(const json_t *object, const char *key, double fallback,
                               double *out) {
    const json_t *value = json_object_get(object, key);
    *out = fallback;
    if (value != NULL && (!finite_number(value, out) || *out < 0.0)) {
        snprintf(problem, sizeof problem, "\"%s\" must be a number, not negative", key);
        return problem;
    }
    return NULL;
}

static const char *read_update(const json_t *object, struct target_objects *objects,
                               struct target_line *out) {
    double radius = 0.0, weight = 1.0, time_us = 0.0;
    const char *wrong = read_id(object, &out->update.id);
    wrong = wrong != NULL ? wrong : read_object(object, objects, &out->update.object);
    wrong = wrong != NULL ? wrong : read_amount(object, "radius", 0.0, &radius);
    wrong = wrong != NULL ? wrong : read_amount(object, "weight", 1.0, &weight);
    wrong = wrong != NULL ? wrong : read_amount(object, "t_us", 0.0, &time_us);
    if (wrong != NULL) {
        return wrong;
    }
    if (weight > 65535.0 || time_us > 9e18) {
        return weight > 65535.0 ? "\"weight\" is more than 65535" : "\"t_us\" is out of range";
    }
    out->has_time = json_object_get(object, "t_us") != NULL;
    out->time_us = (uint64_t)time_us;
    out->update.weight_q16 = (uint32_t)llround(weight * TARGET_WEIGHT_ONE_Q16);
    if (json_is_true(json_object_get(object, "gone"))) {
        out->update.kind = TARGET_GONE;
        return NULL;
    }
    const json_t *xyz = json_object_get(object, "xyz"), *dir = json_object_get(object, "dir");
    if (xyz != NULL && dir == NULL) {
        return read_position(xyz, radius, &out->update);
    }
    if (dir != NULL && xyz == NULL) {
        return read_direction(dir, radius, &out->update);
    }
    if (json_object_get(object, "px") != NULL) {
        return "\"px\" needs a camera model, which this build does not have";
    }
    return "needs either \"xyz\" or \"dir\", or \"gone\": true";
}

const char *target_line_read(const char *text, size_t size, struct target_objects *objects,
                             struct target_line *out, bool *is_blank) {
    size_t start = 0;
    while (start < size && (text[start] == ' ' || text[start] == '\t' || text[start] == '\r')) {
        start++;
    }
    *is_blank = start == size || text[start] == '#';
    memset(out, 0, sizeof *out);
    if (*is_blank) {
        return NULL;
    }
    json_error_t error;
    json_t *object = json_loadb(text, size, JSON_REJECT_DUPLICATES, &error);
    const char *wrong = "not a JSON object";
    if (object == NULL) {
        snprintf(problem, sizeof problem, "not JSON: %s", error.text);
        wrong = problem;
    } else if (json_is_object(object)) {
        wrong = read_update(object, objects, out);
    }
    json_decref(object);
    return wrong;
}

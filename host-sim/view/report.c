#include "view/report.h"

#include "view/markup.h"

#include <stdlib.h>
#include <string.h>

void report_init(struct report *report, const char *title, const char *subtitle) {
    *report = (struct report){.sample_count = 0};
    markup_copy(report->title, sizeof report->title, title);
    markup_copy(report->subtitle, sizeof report->subtitle, subtitle);
}

void report_free(struct report *report) {
    for (size_t i = 0; i < report->picture_count; i++) {
        free(report->pictures[i].points);
        free(report->pictures[i].lines);
    }
    free(report->pictures);
    free(report->samples);
    free(report->facts);
    *report = (struct report){.sample_count = 0};
}

/// The array with room for one more element, or NULL: then the old one is as it was.
static void *with_room(void *array, size_t count, size_t *capacity, size_t element_bytes) {
    if (count < *capacity) {
        return array;
    }
    size_t wanted = *capacity == 0 ? 16 : 2 * *capacity;
    void *moved = wanted > SIZE_MAX / element_bytes ? NULL : realloc(array, wanted * element_bytes);
    if (moved != NULL) {
        *capacity = wanted;
    }
    return moved;
}

bool report_add_sample(struct report *report, const struct report_sample *sample) {
    struct report_sample *samples =
        with_room(report->samples, report->sample_count, &report->sample_capacity, sizeof *samples);
    if (samples == NULL) {
        return false;
    }
    report->samples = samples;
    samples[report->sample_count++] = *sample;
    return true;
}

bool report_add_picture(struct report *report, const struct report_picture *picture) {
    struct report_picture *pictures = with_room(report->pictures, report->picture_count,
                                                &report->picture_capacity, sizeof *pictures);
    if (pictures == NULL) {
        return false;
    }
    report->pictures = pictures;
    struct report_picture copy = *picture;
    copy.points = calloc(picture->point_count + 1, sizeof *copy.points);
    copy.lines = calloc(picture->line_count + 1, sizeof *copy.lines);
    if (copy.points == NULL || copy.lines == NULL) {
        free(copy.points);
        free(copy.lines);
        return false;
    }
    if (picture->line_count > 0) {
        memcpy(copy.lines, picture->lines, picture->line_count * sizeof *copy.lines);
    }
    if (picture->point_count > 0) {
        memcpy(copy.points, picture->points, picture->point_count * sizeof *copy.points);
    }
    pictures[report->picture_count++] = copy;
    return true;
}

bool report_add_fact(struct report *report, const char *name, const char *value) {
    struct report_fact *facts =
        with_room(report->facts, report->fact_count, &report->fact_capacity, sizeof *facts);
    if (facts == NULL) {
        return false;
    }
    report->facts = facts;
    struct report_fact *fact = &facts[report->fact_count++];
    markup_copy(fact->name, sizeof fact->name, name);
    markup_copy(fact->value, sizeof fact->value, value);
    return true;
}

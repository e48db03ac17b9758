#include "scenario_targets.h"

#include "constellations.h"
#include "csv.h"
#include "lines.h"
#include "target_line.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RADIANS (3.14159265358979323846 / 180.0)

static enum exit_status no_memory(const char *path) {
    message_at(path, 0, "no memory for its targets");
    return EXIT_STATUS_FAILURE;
}

// ---------------------------------------------------------------- JSON lines

enum exit_status load_json_lines(const char *path, struct schedule *schedule) {
    struct lines *lines = malloc(sizeof *lines);
    struct target_objects objects = {0};
    if (lines == NULL || !lines_open(lines, path)) {
        free(lines);
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    uint64_t last_us = 0;
    const char *text;
    size_t size;
    enum lines_status read = LINES_OK;
    while (status == EXIT_STATUS_OK && (read = lines_next(lines, &text, &size)) == LINES_OK) {
        struct target_line line;
        bool blank;
        const char *wrong = target_line_read(text, size, &objects, &line, &blank);
        if (wrong == NULL && !blank && line.has_time && line.time_us < last_us) {
            wrong = "\"t_us\" runs backwards";
        }
        if (wrong != NULL) {
            message_at(lines->name, lines->number, "%s", wrong);
            status = EXIT_STATUS_USAGE;
        } else if (!blank) {
            last_us = line.has_time ? line.time_us : last_us;
            const struct schedule_item item = {
                .at_us = last_us, .update = line.update, .size = 1.0};
            status = schedule_add(schedule, &item) ? status : no_memory(path);
        }
    }
    lines_close(lines);
    free(lines);
    return read == LINES_ERROR ? EXIT_STATUS_USAGE : status;
}

// ---------------------------------------------------------------- stars

enum { STAR_HIP, STAR_CONSTELLATION, STAR_FIGURE_OF, STAR_MAGNITUDE, STAR_RA, STAR_DEC };

static int32_t to_q30(double value) {
    return (int32_t)lround(value * 1073741824.0);
}

/// Equatorial to horizon: east, north, up.
static struct vec3 horizon_direction(const struct star_show *show, double ra_deg, double dec_deg) {
    const double latitude = (double)show->latitude_udeg * 1e-6 * RADIANS;
    const double hour_angle = ((double)show->sidereal_us * 1e-6 / 3600.0 * 15.0 - ra_deg) * RADIANS;
    const double dec = dec_deg * RADIANS;
    return vec3(to_q30(-cos(dec) * sin(hour_angle)),
                to_q30(sin(dec) * cos(latitude) - cos(dec) * cos(hour_angle) * sin(latitude)),
                to_q30(sin(dec) * sin(latitude) + cos(dec) * cos(hour_angle) * cos(latitude)));
}

/// Is `name` one of the blank-separated words?
static bool has_word(const char *words, const char *name) {
    const size_t size = strlen(name);
    for (const char *at = words; (at = strstr(at, name)) != NULL; at += size) {
        const bool starts = at == words || at[-1] == ' ';
        if (starts && (at[size] == ' ' || at[size] == '\0')) {
            return true;
        }
    }
    return false;
}

struct star {
    struct schedule_item item;
    char figures[64];
};

/// Reads the catalogue; every star goes to the background.
static enum exit_status read_catalogue(const char *path, const struct star_show *show,
                                       struct schedule *schedule, struct star **stars,
                                       size_t *count) {
    struct csv *csv = malloc(sizeof *csv);
    if (csv == NULL ||
        !csv_open(csv, path, "hip,constellation,figure_of,magnitude,ra_deg,dec_deg")) {
        free(csv);
        return EXIT_STATUS_USAGE;
    }
    enum exit_status status = EXIT_STATUS_OK;
    enum lines_status read = LINES_OK;
    size_t capacity = 0;
    while (status == EXIT_STATUS_OK && (read = csv_next(csv)) == LINES_OK) {
        double hip, magnitude, ra_deg, dec_deg;
        if (!csv_number(csv, STAR_HIP, &hip) || !csv_number(csv, STAR_MAGNITUDE, &magnitude) ||
            !csv_number(csv, STAR_RA, &ra_deg) || !csv_number(csv, STAR_DEC, &dec_deg)) {
            status = EXIT_STATUS_USAGE;
            break;
        }
        if (*count == capacity) {
            capacity = capacity == 0U ? 1024U : 2U * capacity;
            struct star *moved = realloc(*stars, capacity * sizeof **stars);
            if (moved == NULL) {
                status = no_memory(path);
                break;
            }
            *stars = moved;
        }
        struct star *star = &(*stars)[*count];
        memset(star, 0, sizeof *star);
        star->item.update = (struct target_update){
            .kind = TARGET_DIRECTION, .id = (uint32_t)hip, .weight_q16 = TARGET_WEIGHT_ONE_Q16};
        star->item.update.direction = horizon_direction(show, ra_deg, dec_deg);
        star->item.size = fmin(5.0, fmax(0.2, pow(10.0, 0.25 * (2.5 - magnitude))));
        snprintf(star->figures, sizeof star->figures, "%s", csv->field[STAR_FIGURE_OF]);
        status = schedule_add_background(schedule, &star->item) ? status : no_memory(path);
        (*count)++;
    }
    csv_close(csv);
    free(csv);
    return read == LINES_ERROR ? EXIT_STATUS_USAGE : status;
}

/// The figure's stars replace the targets at a time.
static enum exit_status show_figure(const char *path, const char *name, uint64_t at_us,
                                    const struct star *stars, size_t count,
                                    struct schedule *schedule) {
    const struct schedule_item clear = {.at_us = at_us, .update = {.kind = TARGET_CLEAR}};
    bool added = schedule_add_subject(schedule, at_us, constellation_name(name)) &&
                 schedule_add(schedule, &clear);
    size_t members = 0;
    for (size_t i = 0; added && i < count; i++) {
        if (has_word(stars[i].figures, name)) {
            struct schedule_item item = stars[i].item;
            item.at_us = at_us;
            added = schedule_add(schedule, &item);
            members++;
        }
    }
    if (!added) {
        return no_memory(path);
    }
    if (members == 0U) {
        message_at(path, 0, "no star belongs to the figure '%s'", name);
        return EXIT_STATUS_USAGE;
    }
    return EXIT_STATUS_OK;
}

enum exit_status load_stars(const char *path, const struct star_show *show,
                            struct schedule *schedule) {
    struct star *stars = NULL;
    size_t count = 0;
    schedule->noun = "stars";
    enum exit_status status = read_catalogue(path, show, schedule, &stars, &count);
    for (uint32_t i = 0; status == EXIT_STATUS_OK && i < show->figures.count; i++) {
        const uint64_t at_us = (uint64_t)(show->start_us + (int64_t)i * show->dwell_us);
        status = show_figure(path, show->figures.item[i], at_us, stars, count, schedule);
    }
    free(stars);
    return status;
}

// ---------------------------------------------------------------- boxes

enum { BOX_TIME, BOX_LEFT, BOX_TOP, BOX_WIDTH, BOX_HEIGHT, BOX_SCORE, BOX_COLUMNS };

/// A pixel of the fixed camera as a direction: it looks north, x is east, v runs down.
static struct vec3 pixel_direction(const struct box_camera *camera, double u, double v) {
    const double focal_px =
        0.5 * (double)camera->width_px / tan(0.5 * (double)camera->hfov_udeg * 1e-6 * RADIANS);
    const double x = u - 0.5 * (double)(camera->width_px - 1);
    const double z = 0.5 * (double)(camera->height_px - 1) - v;
    const double length = sqrt(x * x + z * z + focal_px * focal_px);
    return vec3(to_q30(x / length), to_q30(focal_px / length), to_q30(z / length));
}

static bool add_box(const struct box_camera *camera, uint64_t at_us, uint32_t number,
                    const double box[BOX_COLUMNS], struct schedule *schedule) {
    bool added = true;
    for (uint32_t corner = 0; added && corner < 4U; corner++) {
        const double u = box[BOX_LEFT] + ((corner & 1U) != 0U ? box[BOX_WIDTH] : 0.0);
        const double v = box[BOX_TOP] + ((corner & 2U) != 0U ? box[BOX_HEIGHT] : 0.0);
        struct schedule_item item = {.at_us = at_us,
                                     .update = {.kind = TARGET_DIRECTION,
                                                .id = number * 4U + corner,
                                                .object = (uint16_t)(number + 1U),
                                                .weight_q16 = TARGET_WEIGHT_ONE_Q16},
                                     .size = 1.0};
        item.update.direction = pixel_direction(camera, u, v);
        added = schedule_add(schedule, &item);
    }
    return added;
}

/// Every frame up to a time begins with an empty set, also those in which nothing was detected.
static bool clear_frames(const struct box_camera *camera, uint64_t *next_us, uint64_t until_us,
                         struct schedule *schedule) {
    for (; *next_us <= until_us; *next_us += (uint64_t)camera->frame_us) {
        const struct schedule_item clear = {.at_us = *next_us, .update = {.kind = TARGET_CLEAR}};
        if (!schedule_add(schedule, &clear)) {
            return false;
        }
    }
    return true;
}

enum exit_status load_boxes(const char *path, const struct box_camera *camera,
                            struct schedule *schedule) {
    struct csv *csv = malloc(sizeof *csv);
    if (csv == NULL || !csv_open(csv, path, "time_ms,left_px,top_px,width_px,height_px,score")) {
        free(csv);
        return EXIT_STATUS_USAGE;
    }
    schedule->noun = "corners";
    enum exit_status status = EXIT_STATUS_OK;
    enum lines_status read = LINES_OK;
    uint64_t next_frame_us = 0, last_us = 0;
    uint32_t number = 0;
    while (status == EXIT_STATUS_OK && (read = csv_next(csv)) == LINES_OK) {
        double box[BOX_COLUMNS];
        bool good = true;
        for (unsigned column = 0; good && column < BOX_COLUMNS; column++) {
            good = csv_number(csv, column, &box[column]);
        }
        const uint64_t at_us = good ? (uint64_t)(box[BOX_TIME] * 1000.0) : 0U;
        if (good && (box[BOX_TIME] < 0.0 || at_us < last_us)) {
            message_at(csv->lines.name, csv->lines.number, "time runs backwards");
            good = false;
        }
        if (!good) {
            status = EXIT_STATUS_USAGE;
            break;
        }
        number = at_us != last_us ? 0U : number;
        last_us = at_us;
        bool added = clear_frames(camera, &next_frame_us, at_us, schedule);
        if (added && box[BOX_SCORE] * 1000.0 > (double)camera->score_min_millis) {
            added = add_box(camera, at_us, number++, box, schedule);
        }
        status = added ? status : no_memory(path);
    }
    csv_close(csv);
    free(csv);
    return read == LINES_ERROR ? EXIT_STATUS_USAGE : status;
}

#include "board_targets.h"

#include "app/program_link.h"
#include "link/compact.h"

#include <math.h>
#include <string.h>

#define LINE_BODY_BYTES (CHECKED_LINE_BYTES_MAX - CHECKED_LINE_BYTES_AROUND)
#define TURN_BAM        4294967296.0
#define RADIAN_BAM      (TURN_BAM / 6.283185307179586476925)

/// A target as text has at most: id, `dir`, three numbers, radius, weight, object.
#define TEXT_BYTES 128U

void board_targets_init(struct board_targets *targets, struct vec3_i64 viewpoint_um) {
    memset(targets, 0, sizeof *targets);
    targets->viewpoint_um = viewpoint_um;
}

void board_targets_renew(struct board_targets *targets, uint64_t now_us) {
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) {
        targets->target[i].news = targets->target[i].used;
    }
    targets->has_news = targets->count > 0U;
    targets->first_news_us = targets->last_news_us = now_us;
}

bool board_targets_take(struct board_targets *targets, const struct target_update *update,
                        uint64_t now_us) {
    struct board_target *free_place = NULL, *place = NULL;
    for (uint32_t i = 0; i < TARGET_CAPACITY && place == NULL; i++) {
        struct board_target *target = &targets->target[i];
        if (target->used && target->update.id == update->id) {
            place = target;
        } else if (!target->used && free_place == NULL) {
            free_place = target;
        }
    }
    if (place == NULL && update->kind == TARGET_GONE) {
        return true;
    }
    if (place == NULL && free_place == NULL) {
        return false;
    }
    if (place == NULL) {
        place = free_place;
        targets->count++;
        targets->most = targets->count > targets->most ? targets->count : targets->most;
    }
    *place = (struct board_target){.used = true, .news = true, .update = *update};
    targets->first_news_us = targets->has_news ? targets->first_news_us : now_us;
    targets->last_news_us = now_us;
    targets->has_news = true;
    return true;
}

static void sent(struct board_targets *targets, struct board_target *target) {
    target->news = false;
    if (target->update.kind == TARGET_GONE) {
        target->used = false;
        targets->count--;
    }
}

// ---------------------------------------------------------------- as text

static void put_decimal(struct text *text, int64_t value, unsigned places) {
    text_character(text, ' ');
    text_decimal(text, value, places);
}

/// Directions have up to 31 bits: nine places of a number below 1 are enough for them.
static void put_direction(struct text *text, struct vec3 direction) {
    const int32_t v[3] = {direction.x, direction.y, direction.z};
    text_string(text, " dir");
    for (unsigned i = 0; i < 3U; i++) {
        put_decimal(text, llround((double)v[i] / 2147483648.0 * 1e9), 9);
    }
}

/// RADIUS WEIGHT OBJECT, as far as they are not what is taken without them.
static void put_rest(struct text *text, const struct target_update *update) {
    const bool is_position = update->kind == TARGET_POSITION;
    const bool has_object = update->object != 0U;
    const bool has_weight = has_object || update->weight_q16 != TARGET_WEIGHT_ONE_Q16;
    const uint32_t radius = is_position ? update->radius_um : update->radius_bam32;
    if (has_weight || radius != 0U) {
        const int64_t micro =
            is_position ? (int64_t)radius : (int64_t)ceil((double)radius / TURN_BAM * 360e6);
        put_decimal(text, micro, 6);
    }
    if (has_weight) {
        put_decimal(text, llround((double)update->weight_q16 / 65536.0 * 1e6), 6);
    }
    if (has_object) {
        put_decimal(text, update->object, 0);
    }
}

static void write_text(const struct target_update *update, uint32_t number, struct text *text) {
    text_unsigned(text, number, 0);
    if (update->kind == TARGET_GONE) {
        text_string(text, " gone");
        return;
    }
    if (update->kind == TARGET_POSITION) {
        put_decimal(text, update->position_um.x, 6);
        put_decimal(text, update->position_um.y, 6);
        put_decimal(text, update->position_um.z, 6);
    } else {
        put_direction(text, update->direction);
    }
    put_rest(text, update);
}

// ---------------------------------------------------------------- as six characters

static bool is_viewpoint(const struct board_targets *targets, const struct vec3_i64 *position_um) {
    return position_um->x == targets->viewpoint_um.x && position_um->y == targets->viewpoint_um.y &&
           position_um->z == targets->viewpoint_um.z;
}

/// Does a direction say all of it? A point at the viewpoint has none: the board is to reject it.
static bool is_compact(const struct board_targets *targets, const struct target_update *update) {
    const bool is_position = update->kind == TARGET_POSITION;
    const uint32_t radius = is_position ? update->radius_um : update->radius_bam32;
    return update->kind != TARGET_GONE && radius == 0U &&
           update->weight_q16 == TARGET_WEIGHT_ONE_Q16 && update->object == 0U &&
           !(is_position && is_viewpoint(targets, &update->position_um));
}

static void write_compact(const struct board_targets *targets, const struct target_update *update,
                          struct text *text) {
    double x = update->direction.x, y = update->direction.y, z = update->direction.z;
    if (update->kind == TARGET_POSITION) {
        x = (double)(update->position_um.x - targets->viewpoint_um.x);
        y = (double)(update->position_um.y - targets->viewpoint_um.y);
        z = (double)(update->position_um.z - targets->viewpoint_um.z);
    }
    const int64_t pan = llround(atan2(x, y) * RADIAN_BAM);
    const int64_t tilt = llround(atan2(z, hypot(x, y)) * RADIAN_BAM);
    compact_write(text, bam32((uint32_t)(uint64_t)pan), bam32((uint32_t)(uint64_t)tilt));
}

// ---------------------------------------------------------------- a frame

/// A line that is being filled, and the one before it, of which it is not yet known whether it is
/// the frame's last.
struct filling {
    struct board_link *link;
    uint64_t now_us;
    int64_t budget_bytes; ///< that are left of this frame
    struct text body;
    uint32_t empty_bytes; ///< of the body without targets
    uint32_t next_number; ///< compact: that the next code belongs to
    char buffer[LINE_BODY_BYTES];
    char full_type; ///< 0: there is none
    struct text full;
    char full_buffer[LINE_BODY_BYTES];
};

static void begin_line(struct filling *line) {
    text_begin(&line->body, line->buffer, sizeof line->buffer);
    board_link_stamp(line->link, line->now_us, &line->body);
    text_character(&line->body, PROGRAM_LINK_MORE);
    line->empty_bytes = line->body.size_bytes;
}

/// False: there is no room for the line.
static bool send_full(struct filling *line, char more) {
    const char type = line->full_type;
    line->full_type = 0;
    line->full_buffer[PROGRAM_LINK_STAMP_HEX] = more;
    return type == 0 || board_link_send_targets(line->link, type, &line->full);
}

/// False: there was no room for the line before.
static bool end_line(struct filling *line, char type) {
    if (line->body.size_bytes == line->empty_bytes) {
        return true;
    }
    const bool good = send_full(line, PROGRAM_LINK_MORE);
    line->budget_bytes -= line->body.size_bytes + CHECKED_LINE_BYTES_AROUND;
    text_begin(&line->full, line->full_buffer, sizeof line->full_buffer);
    text_characters(&line->full, line->buffer, line->body.size_bytes);
    line->full_type = type;
    begin_line(line);
    return good;
}

static bool has_budget(const struct filling *line, uint32_t more_bytes) {
    return line->budget_bytes >=
           (int64_t)(line->body.size_bytes + more_bytes + CHECKED_LINE_BYTES_AROUND);
}

static bool add_text(struct filling *line, const struct target_update *update, uint32_t number) {
    char buffer[TEXT_BYTES];
    struct text item;
    text_begin(&item, buffer, sizeof buffer);
    write_text(update, number, &item);
    if (line->body.size_bytes + 1U + item.size_bytes > LINE_BODY_BYTES && !end_line(line, 't')) {
        return false;
    }
    if (!has_budget(line, item.size_bytes + 1U)) {
        return false;
    }
    if (line->body.size_bytes != line->empty_bytes) {
        text_character(&line->body, ';');
    }
    text_characters(&line->body, item.buffer, item.size_bytes);
    return true;
}

/// A few numbers without news are left out with a character each; more begin a new line.
static bool add_compact(struct filling *line, const struct board_targets *targets,
                        const struct target_update *update, uint32_t number) {
    const bool is_first = line->body.size_bytes == line->empty_bytes;
    const uint32_t gap = is_first ? 0U : number - line->next_number;
    const uint32_t size = gap + COMPACT_CHARACTERS;
    if (!is_first && (number < line->next_number || gap > 12U ||
                      line->body.size_bytes + size > LINE_BODY_BYTES)) {
        return end_line(line, 'd') && add_compact(line, targets, update, number);
    }
    if (!has_budget(line, size + 2U)) {
        return false;
    }
    if (is_first) {
        text_hex_digits(&line->body, number, 2);
    }
    for (uint32_t i = 0; i < gap; i++) {
        text_character(&line->body, '~');
    }
    write_compact(targets, update, &line->body);
    line->next_number = number + 1U;
    return true;
}

/// Sends news of one kind, beginning with number `next`. False: not all of them fit.
static bool send_news(struct board_targets *targets, struct filling *line, bool compact_too,
                      bool as_compact) {
    begin_line(line);
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) {
        const uint32_t number = (targets->next + i) % TARGET_CAPACITY;
        struct board_target *target = &targets->target[number];
        if (!target->news || (is_compact(targets, &target->update) && compact_too) != as_compact) {
            continue;
        }
        const bool added = as_compact ? add_compact(line, targets, &target->update, number)
                                      : add_text(line, &target->update, number);
        if (!added) {
            (void)end_line(line, as_compact ? 'd' : 't');
            targets->next = number;
            return false;
        }
        sent(targets, target);
    }
    return end_line(line, as_compact ? 'd' : 't');
}

static int64_t text_bytes(const struct board_targets *targets) {
    int64_t bytes = 0;
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) {
        if (targets->target[i].news) {
            char buffer[TEXT_BYTES];
            struct text item;
            text_begin(&item, buffer, sizeof buffer);
            write_text(&targets->target[i].update, i, &item);
            bytes += item.size_bytes + 1U;
        }
    }
    // What each line has around its targets.
    return bytes +
           (bytes / (LINE_BODY_BYTES - TEXT_BYTES) + 1) * (int64_t)(CHECKED_LINE_BYTES_AROUND + 5U);
}

bool board_targets_due(const struct board_targets *targets, const struct board_link *link,
                       uint64_t now_us) {
    return targets->has_news && board_link_waiting(link) == 0U &&
           (now_us - targets->last_news_us >= BOARD_TARGETS_QUIET_US ||
            now_us - targets->first_news_us >= BOARD_TARGETS_WAIT_US);
}

void board_targets_send(struct board_targets *targets, struct board_link *link, uint64_t now_us) {
    // Nine tenths of what the line carries; the rest is for questions and commands.
    const int64_t line_carries =
        (int64_t)link->bytes_a_second * BOARD_TARGETS_FRAME_US / 1000000 * 9 / 10;
    const int64_t carries =
        line_carries < (int64_t)BOARD_LINK_OUT_BYTES ? line_carries : (int64_t)BOARD_LINK_OUT_BYTES;
    struct filling line = {
        .link = link, .now_us = now_us, .budget_bytes = carries - board_link_waiting(link)};
    const int64_t wanted = text_bytes(targets);
    const bool compact = wanted > line.budget_bytes;
    bool all = send_news(targets, &line, compact, false);
    if (all && compact) {
        all = send_news(targets, &line, true, true);
    }
    const bool any = line.full_type != 0;
    (void)send_full(&line, PROGRAM_LINK_LAST);
    targets->compact_frames += any && compact;
    targets->text_frames += any && !compact;
    targets->cut_frames += !all;
    targets->has_news = !all;
    targets->first_news_us = now_us;
}

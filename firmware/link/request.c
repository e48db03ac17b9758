#include "link/request.h"

#include "fixed/trig.h"

#include <stddef.h>

#define MICRO INT64_C(1000000)
#define NANO  INT64_C(1000000000)

/// Half a turn in millionths of a degree; angles are given up to a whole one.
#define HALF_TURN_MICRO (180 * MICRO)

static const char *const expected_target =
    "expected ID X Y Z [RADIUS] in metres, or ID dir X Y Z [RADIUS] with the radius in degrees";

// ---------------------------------------------------------------- values

/// degrees * 10^6 (at most a turn) to BAM, rounded to nearest, half up.
static bam32_t bam_from_micro(int64_t angle_micro) {
    const int64_t turns_q32 = angle_micro * (INT64_C(1) << 32);
    const int64_t turn = 2 * HALF_TURN_MICRO;
    const int64_t shifted = turns_q32 + turn / 2;
    return bam32((uint32_t)(shifted / turn - (shifted % turn < 0)));
}

static bool read_position(struct words *words, struct vec3_i64 *position_um) {
    int64_t um[3];
    for (unsigned i = 0; i < 3U; i++) {
        struct word word;
        if (!words_next(words, &word) || !word_decimal(word, 6, TARGET_POSITION_UM_MAX, &um[i])) {
            return false;
        }
    }
    *position_um = (struct vec3_i64){um[0], um[1], um[2]};
    return true;
}

static uint64_t size_of(int64_t value) {
    return value < 0 ? 0U - (uint64_t)value : (uint64_t)value;
}

/// Three numbers of any size with up to nine places, scaled by a power of two until the largest
/// fills 31 bits: what is lost is below 2^-30 of it.
static bool read_direction(struct words *words, struct vec3 *direction) {
    int64_t v[3];
    uint64_t all = 0;
    for (unsigned i = 0; i < 3U; i++) {
        struct word word;
        if (!words_next(words, &word) || !word_decimal(word, 9, 1000 * NANO, &v[i])) {
            return false;
        }
        all |= size_of(v[i]);
    }
    if (all == 0U) {
        return false;
    }
    unsigned down = 0, up = 0;
    while (all >> down >= UINT64_C(1) << 31) {
        down++;
    }
    while (down == 0U && all << up < UINT64_C(1) << 30) {
        up++;
    }
    for (unsigned i = 0; i < 3U; i++) {
        const int64_t magnitude = (int64_t)(size_of(v[i]) << up >> down);
        v[i] = v[i] < 0 ? -magnitude : magnitude;
    }
    *direction = vec3((int32_t)v[0], (int32_t)v[1], (int32_t)v[2]);
    return true;
}

/// An optional number that is not negative. False: there is one, and it is wrong.
static bool read_amount(struct words *words, int64_t most, int64_t *amount_micro) {
    struct word word;
    return !words_next(words, &word) ||
           (word_decimal(word, 6, most, amount_micro) && *amount_micro >= 0);
}

/// Behind the coordinates: [RADIUS [WEIGHT [OBJECT]]].
static bool read_rest(struct words *words, struct target_update *update) {
    const bool is_position = update->kind == TARGET_POSITION;
    int64_t radius_micro = 0, weight_micro = MICRO, object_micro = 0;
    if (!read_amount(words, is_position ? 4000 * MICRO : 90 * MICRO - 1, &radius_micro) ||
        !read_amount(words, 65535 * MICRO, &weight_micro) ||
        !read_amount(words, 65535 * MICRO, &object_micro) || !words_at_end(words) ||
        object_micro % MICRO != 0) {
        return false;
    }
    update->weight_q16 = (uint32_t)((weight_micro * TARGET_WEIGHT_ONE_Q16 + MICRO / 2) / MICRO);
    update->object = (uint16_t)(object_micro / MICRO);
    if (is_position) {
        update->radius_um = (uint32_t)radius_micro;
    } else {
        update->radius_bam32 = bam_from_micro(radius_micro).bam;
    }
    return true;
}

// ---------------------------------------------------------------- targets

static const char *read_id(struct words *words, uint32_t *id) {
    struct word word;
    return words_next(words, &word) && word_unsigned(word, REQUEST_AIM_ID - 1U, id)
               ? NULL
               : "expected a number from 0 to 4294967294 for the target";
}

static const char *read_target(struct words *words, struct target_update *update) {
    *update = (struct target_update){.kind = TARGET_POSITION};
    const char *wrong = read_id(words, &update->id);
    if (wrong != NULL) {
        return wrong;
    }
    struct words ahead = *words;
    struct word word;
    const bool more = words_next(&ahead, &word);
    bool good;
    if (more && word_is(word, "dir")) {
        *words = ahead;
        update->kind = TARGET_DIRECTION;
        good = read_direction(words, &update->direction);
    } else {
        good = read_position(words, &update->position_um);
    }
    return good && read_rest(words, update) ? NULL : expected_target;
}

const char *request_read_target(const char *text, uint32_t size_bytes,
                                struct target_update *update) {
    struct words words = words_of(text, size_bytes), ahead = words;
    struct word id, what;
    if (words_next(&ahead, &id) && words_next(&ahead, &what) && word_is(what, "gone")) {
        *update = (struct target_update){.kind = TARGET_GONE};
        return read_id(&words, &update->id) == NULL && words_at_end(&ahead) ? NULL
                                                                            : "expected ID gone";
    }
    return read_target(&words, update);
}

struct target_update request_aim(bam32_t pan, bam32_t tilt, uint32_t radius_bam32) {
    const struct sincos p = trig_sincos(pan), t = trig_sincos(tilt);
    return (struct target_update){
        .kind = TARGET_DIRECTION,
        .id = REQUEST_AIM_ID,
        .weight_q16 = TARGET_WEIGHT_ONE_Q16,
        .direction = vec3(q30_mul(p.sin_q30, t.cos_q30), q30_mul(p.cos_q30, t.cos_q30), t.sin_q30),
        .radius_bam32 = radius_bam32};
}

// ---------------------------------------------------------------- commands

static const char *read_aim(struct words *words, struct request *request) {
    int64_t pan_micro, tilt_micro, radius_micro = 0;
    struct word pan, tilt;
    if (!words_next(words, &pan) || !word_decimal(pan, 6, 2 * HALF_TURN_MICRO, &pan_micro) ||
        !words_next(words, &tilt) || !word_decimal(tilt, 6, HALF_TURN_MICRO / 2, &tilt_micro) ||
        !read_amount(words, 90 * MICRO - 1, &radius_micro) || !words_at_end(words)) {
        return "expected PAN TILT [RADIUS] in degrees: aim 30 -5.5; pan -360 to 360, tilt -90 to "
               "90, radius below 90";
    }
    request->update = request_aim(bam_from_micro(pan_micro), bam_from_micro(tilt_micro),
                                  bam_from_micro(radius_micro).bam);
    return NULL;
}

static const char *read_gone(struct words *words, struct request *request) {
    request->update = (struct target_update){.kind = TARGET_GONE};
    const char *wrong = read_id(words, &request->update.id);
    return wrong != NULL || words_at_end(words) ? wrong : "expected one number: gone 7";
}

static const char *read_get(struct words *words, struct request *request) {
    (void)!words_next(words, &request->name);
    return words_at_end(words) ? NULL
                               : "expected one name, or none for all: get tilt.limit_max_deg";
}

static const char *read_set(struct words *words, struct request *request) {
    struct word value;
    if (!words_next(words, &request->name) || !words_next(words, &value) || !words_at_end(words)) {
        return "expected NAME VALUE: set camera.margin_percent 20; `get` lists the names";
    }
    return word_decimal(value, 6, REQUEST_VALUE_MICRO_MAX, &request->value_micro)
               ? NULL
               : "expected a number up to a million, with at most six places";
}

static const char *read_trace(struct words *words, struct request *request) {
    struct word word, period;
    request->period_ms = REQUEST_TRACE_MS_DEFAULT;
    const bool more = words_next(words, &word);
    request->on = word_is(word, "on");
    if (more && (request->on || word_is(word, "off")) &&
        (!request->on || !words_next(words, &period) ||
         (word_unsigned(period, REQUEST_TRACE_MS_MAX, &request->period_ms) &&
          request->period_ms >= REQUEST_TRACE_MS_MIN)) &&
        words_at_end(words)) {
        return NULL;
    }
    return "expected on or off: trace on, trace on 100 (every 100 ms; 10 to 60000), trace off";
}

static const char *read_scene(struct words *words, struct request *request) {
    return read_position(words, &request->update.position_um) && words_at_end(words)
               ? NULL
               : "expected X Y Z in metres: scene 0 -12.5 1.8";
}

static const char *read_pan(struct words *words, struct request *request) {
    static const char *const expected =
        "expected OBJECT or all, SECONDS up to 3600, and sum or angle if not sum: pan 2 3.5 angle";
    struct word object, seconds, path;
    uint32_t number = 0;
    int64_t duration_us;
    if (!words_next(words, &object)) {
        return expected;
    }
    request->choice.one_object = !word_is(object, "all");
    if ((request->choice.one_object && !word_unsigned(object, UINT16_MAX, &number)) ||
        !words_next(words, &seconds) ||
        !word_decimal(seconds, 6, REQUEST_PAN_US_MAX, &duration_us) || duration_us < 0) {
        return expected;
    }
    request->choice.object = (uint16_t)number;
    request->duration_us = (uint32_t)duration_us;
    request->path = PAN_BY_SUM;
    if (words_next(words, &path)) {
        request->path = word_is(path, "angle") ? PAN_BY_ANGLE : PAN_BY_SUM;
        if (!word_is(path, "angle") && !word_is(path, "sum")) {
            return expected;
        }
    }
    return words_at_end(words) ? NULL : expected;
}

static const struct {
    const char *name;
    enum request_kind kind;
    const char *help;
} commands[] = {
    {"help", REQUEST_HELP, "help                         this list"},
    {"status", REQUEST_STATUS, "status                       how the board is and why"},
    {"arm", REQUEST_ARM, "arm                          let the axes move"},
    {"stop", REQUEST_STOP, "stop                         decelerate and hold; so does Ctrl-C"},
    {"home", REQUEST_HOME, "home                         look where the axes are at home"},
    {"aim", REQUEST_AIM,
     "aim PAN TILT [RADIUS]        look there, degrees in the world; drops all targets"},
    {"target", REQUEST_UPDATE,
     "target ID X Y Z [RADIUS]     a point to watch, metres: east, north, up"},
    {"target", REQUEST_UPDATE,
     "target ID dir X Y Z [RADIUS] a direction to watch, radius in degrees"},
    {"gone", REQUEST_UPDATE, "gone ID                      watch it no longer"},
    {"pan", REQUEST_PAN,
     "pan OBJECT|all SECONDS       turn to one object, or all; behind it sum or angle"},
    {"get", REQUEST_GET,
     "get [NAME]                   settings that can be changed, with their range"},
    {"set", REQUEST_SET, "set NAME VALUE               change one until the next reset"},
    {"scene", REQUEST_SCENE,
     "scene X Y Z                  aim at the scene in flash, seen from there, metres"},
    {"trace", REQUEST_TRACE, "trace on [MS] | off          a line of telemetry every so often"},
};

#define COMMAND_COUNT (sizeof commands / sizeof commands[0])

const char *request_help(uint32_t index) {
    return index < COMMAND_COUNT ? commands[index].help : NULL;
}

static const char *read_arguments(struct word name, struct words *words, struct request *request) {
    switch (request->kind) {
    case REQUEST_AIM:
        return read_aim(words, request);
    case REQUEST_UPDATE:
        return word_is(name, "gone") ? read_gone(words, request)
                                     : read_target(words, &request->update);
    case REQUEST_GET:
        return read_get(words, request);
    case REQUEST_SET:
        return read_set(words, request);
    case REQUEST_TRACE:
        return read_trace(words, request);
    case REQUEST_SCENE:
        return read_scene(words, request);
    case REQUEST_PAN:
        return read_pan(words, request);
    default:
        return words_at_end(words) ? NULL : "expected nothing behind this command";
    }
}

const char *request_read(const char *text, uint32_t size_bytes, struct request *request) {
    struct words words = words_of(text, size_bytes);
    struct word name;
    if (words_next(&words, &name)) {
        for (uint32_t i = 0; i < COMMAND_COUNT; i++) {
            if (word_is(name, commands[i].name)) {
                *request = (struct request){.kind = commands[i].kind};
                return read_arguments(name, &words, request);
            }
        }
    }
    return "no such command; `help` lists them";
}

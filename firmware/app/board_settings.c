#include "app/board_settings.h"

#include <stddef.h>

#define MICRO       INT64_C(1000000)
#define TURN_MICRO  (360 * MICRO)
#define RANGE_MICRO (3600 * MICRO)

enum quantity {
    MARGIN,
    EXPIRY,
    SMOOTHING,
    COAST,
    JUMP,
    LIMIT_MIN, // from here on: of an axis, and only while no axis is driven
    LIMIT_MAX,
    SPEED,
    ACCEL
};

static const struct setting {
    const char *name;
    enum quantity quantity;
    uint8_t axis;
    uint8_t places; ///< that the stored number is good for
    int64_t min_micro, max_micro;
} table[] = {
    {"camera.margin_percent", MARGIN, 0, 2, 0, 900 * MICRO},
    {"controller.target_expiry_ms", EXPIRY, 0, 3, 0, 1000000 * MICRO},
    {"controller.smoothing_percent", SMOOTHING, 0, 2, 0, 99 * MICRO},
    {"controller.coast_ms", COAST, 0, 3, 0, 60000 * MICRO},
    {"controller.jump_deg", JUMP, 0, 5, 0, 180 * MICRO},
    {"pan.limit_min_deg", LIMIT_MIN, AXIS_PAN, 5, -RANGE_MICRO, RANGE_MICRO},
    {"pan.limit_max_deg", LIMIT_MAX, AXIS_PAN, 5, -RANGE_MICRO, RANGE_MICRO},
    {"pan.speed_max_dps", SPEED, AXIS_PAN, 2, MICRO / 100, RANGE_MICRO},
    {"pan.accel_max_dps2", ACCEL, AXIS_PAN, 1, MICRO / 10, 20000 * MICRO},
    {"tilt.limit_min_deg", LIMIT_MIN, AXIS_TILT, 5, -RANGE_MICRO, RANGE_MICRO},
    {"tilt.limit_max_deg", LIMIT_MAX, AXIS_TILT, 5, -RANGE_MICRO, RANGE_MICRO},
    {"tilt.speed_max_dps", SPEED, AXIS_TILT, 2, MICRO / 100, RANGE_MICRO},
    {"tilt.accel_max_dps2", ACCEL, AXIS_TILT, 1, MICRO / 10, 20000 * MICRO},
};

#define COUNT (sizeof table / sizeof table[0])

// ---------------------------------------------------------------- units

/// degrees * 10^6 to 2^-48 turns, rounded down to 2^-28 turns. |degrees|: at most 20,000.
static int64_t q48_from_micro(int64_t micro) {
    const int64_t part = micro * (INT64_C(1) << 28), whole = TURN_MICRO;
    return (part / whole - (part % whole < 0)) * (INT64_C(1) << 20);
}

/// Rounded to nearest: what was set comes back.
static int64_t micro_from_q48(int64_t turns_q48) {
    const int64_t q28 = turns_q48 / (INT64_C(1) << 20) - (turns_q48 % (INT64_C(1) << 20) < 0);
    const int64_t scaled = q28 * TURN_MICRO + (INT64_C(1) << 27);
    return scaled / (INT64_C(1) << 28) - (scaled % (INT64_C(1) << 28) < 0);
}

/// Of a rate per second the rate per tick: times tick_us / 10^6.
static int64_t per_tick(int64_t rate_q48, uint32_t tick_us) {
    return rate_q48 / 1000 * tick_us / 1000;
}

/// At most 60 turns, which micro_from_q48 can take.
static int64_t per_second(int64_t rate_q48, uint32_t tick_us) {
    const int64_t most = (INT64_C(60) << 48) / MICRO * tick_us;
    return (rate_q48 < most ? rate_q48 : most) * 1000 / tick_us * 1000;
}

static uint32_t q16_from_percent(int64_t micro) {
    return (uint32_t)((micro * 65536 + 50 * MICRO) / (100 * MICRO));
}

static int64_t percent_from_q16(uint32_t part_q16) {
    return ((int64_t)part_q16 * 100 * MICRO + 32768) / 65536;
}

// ---------------------------------------------------------------- values

static int64_t read_value(const struct setting *setting, const struct controller_config *config) {
    const struct limiter_config *limits = &config->axis[setting->axis].limits;
    switch (setting->quantity) {
    case MARGIN:
        return percent_from_q16(config->lens.margin_q16);
    case EXPIRY: {
        const uint64_t most = 1000000000U; // the rig file allows more than a console shows
        return (int64_t)(config->target_expiry_us < most ? config->target_expiry_us : most) * 1000;
    }
    case SMOOTHING:
        return percent_from_q16(config->tracker.memory_q16);
    case COAST:
        return (int64_t)config->tracker.coast_ticks * config->tick_us * 1000;
    case JUMP:
        return micro_from_q48(config->tracker.jump_q48);
    case LIMIT_MIN:
        return micro_from_q48(limits->min_q48);
    case LIMIT_MAX:
        return micro_from_q48(limits->max_q48);
    case SPEED:
        return micro_from_q48(per_second(limits->speed_max_q48, config->tick_us));
    default:
        return micro_from_q48(
            per_second(per_second(limits->accel_max_q48, config->tick_us), config->tick_us));
    }
}

static void write_value(const struct setting *setting, int64_t micro,
                        struct controller_config *config) {
    struct limiter_config *limits = &config->axis[setting->axis].limits;
    const uint32_t tick_us = config->tick_us;
    switch (setting->quantity) {
    case MARGIN:
        config->lens.margin_q16 = q16_from_percent(micro);
        break;
    case EXPIRY:
        config->target_expiry_us = (uint64_t)micro / 1000U;
        break;
    case SMOOTHING:
        config->tracker.memory_q16 = q16_from_percent(micro);
        break;
    case COAST:
        config->tracker.coast_ticks = (uint32_t)(micro / 1000) / tick_us;
        break;
    case JUMP:
        config->tracker.jump_q48 = q48_from_micro(micro);
        break;
    case LIMIT_MIN:
        limits->min_q48 = q48_from_micro(micro);
        break;
    case LIMIT_MAX:
        limits->max_q48 = q48_from_micro(micro);
        break;
    case SPEED:
        limits->speed_max_q48 = per_tick(q48_from_micro(micro), tick_us);
        break;
    default:
        limits->accel_max_q48 = per_tick(per_tick(q48_from_micro(micro), tick_us), tick_us);
        break;
    }
}

// ---------------------------------------------------------------- reading

void board_settings_init(struct board_settings *settings, const struct controller_config *built) {
    settings->built = built;
    settings->now = *built;
}

/// How many of the smallest unit shown a value has: 10^-places, rounded to nearest.
static int64_t rounded(const struct setting *setting, int64_t micro) {
    int64_t unit = 1;
    for (unsigned i = setting->places; i < 6U; i++) {
        unit *= 10;
    }
    return (micro + (micro < 0 ? -(unit / 2) : unit / 2)) / unit;
}

static void write_rounded(struct text *text, const struct setting *setting, int64_t micro) {
    text_decimal(text, rounded(setting, micro), setting->places);
}

static void write_setting(const struct setting *setting, const struct controller_config *config,
                          struct text *text) {
    text_string(text, setting->name);
    text_character(text, ' ');
    write_rounded(text, setting, read_value(setting, config));
}

bool board_settings_list(const struct board_settings *settings, uint32_t index, struct text *text) {
    if (index >= COUNT) {
        return false;
    }
    const struct setting *setting = &table[index];
    write_setting(setting, &settings->now, text);
    text_string(text, "  (");
    const int64_t built = read_value(setting, settings->built);
    const bool is_rate = setting->quantity == SPEED || setting->quantity == ACCEL;
    const int64_t min = setting->quantity == LIMIT_MIN ? built : setting->min_micro;
    const int64_t max = is_rate || setting->quantity == LIMIT_MAX ? built : setting->max_micro;
    if (setting->quantity != LIMIT_MAX) {
        text_string(text, "from ");
        write_rounded(text, setting, min);
    }
    if (setting->quantity != LIMIT_MIN) {
        text_string(text, setting->quantity != LIMIT_MAX ? " to " : "to ");
        write_rounded(text, setting, max);
    }
    text_string(text, setting->quantity < LIMIT_MIN ? ")" : "; not while driven)");
    return true;
}

static const struct setting *find(struct word name) {
    for (uint32_t i = 0; i < COUNT; i++) {
        if (word_is(name, table[i].name)) {
            return &table[i];
        }
    }
    return NULL;
}

static const char *const unknown = "no such setting; `get` lists them";

const char *board_settings_get(const struct board_settings *settings, struct word name,
                               struct text *text) {
    const struct setting *setting = find(name);
    if (setting == NULL) {
        return unknown;
    }
    write_setting(setting, &settings->now, text);
    return NULL;
}

// ---------------------------------------------------------------- changing

/// What the image was built for bounds it, as it is shown; at a bound, the bound itself is taken.
static bool hold_within_built(const struct setting *setting, int64_t value_micro,
                              const struct controller_config *built,
                              struct controller_config *wanted) {
    const int64_t bound = rounded(setting, read_value(setting, built));
    const int64_t value = rounded(setting, value_micro);
    if (setting->quantity == LIMIT_MIN ? value < bound : value > bound) {
        return false;
    }
    struct limiter_config *limits = &wanted->axis[setting->axis].limits;
    const struct limiter_config *most = &built->axis[setting->axis].limits;
    limits->min_q48 = limits->min_q48 < most->min_q48 ? most->min_q48 : limits->min_q48;
    limits->max_q48 = limits->max_q48 > most->max_q48 ? most->max_q48 : limits->max_q48;
    if (limits->speed_max_q48 > most->speed_max_q48) {
        limits->speed_max_q48 = most->speed_max_q48;
    }
    if (limits->accel_max_q48 > most->accel_max_q48) {
        limits->accel_max_q48 = most->accel_max_q48;
    }
    return true;
}

static bool is_driven(const struct controller *controller) {
    return controller->powered[AXIS_PAN] || controller->powered[AXIS_TILT] ||
           controller->powered[AXIS_ZOOM] || controller->arm_wanted;
}

static const char *set_limit(struct board_settings *settings, const struct setting *setting,
                             int64_t value_micro, struct controller *controller) {
    if (is_driven(controller)) {
        return "not while an axis is driven: it can be changed after a reset, before arming";
    }
    struct controller_config wanted = settings->now;
    write_value(setting, value_micro, &wanted);
    if (!hold_within_built(setting, value_micro, settings->built, &wanted)) {
        return "beyond what the rig file allows: change that, and flash the board";
    }
    const struct controller_axis_config *axis = &wanted.axis[setting->axis];
    if (axis->limits.min_q48 > axis->home_q48 || axis->limits.max_q48 < axis->home_q48) {
        return "the home position would be outside";
    }
    if (axis->limits.speed_max_q48 < 1 || axis->limits.accel_max_q48 < 1) {
        return "too small for this tick";
    }
    wanted.arm_on_start = false; // a change of settings is no reason to move
    settings->now = wanted;
    return controller_init(controller, &settings->now) ? NULL : "the settings are not valid";
}

const char *board_settings_set(struct board_settings *settings, struct word name,
                               int64_t value_micro, struct controller *controller) {
    const struct setting *setting = find(name);
    if (setting == NULL) {
        return unknown;
    }
    if (value_micro < setting->min_micro || value_micro > setting->max_micro) {
        return "out of range; `get` shows it";
    }
    if (setting->quantity >= LIMIT_MIN) {
        return set_limit(settings, setting, value_micro, controller);
    }
    write_value(setting, value_micro, &settings->now);
    controller_take_settings(controller);
    return NULL;
}

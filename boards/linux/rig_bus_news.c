#include "rig_bus.h"

#include <stdio.h>
#include <string.h>

#define REMEDY "check cable, termination, bit rate and the drives' power"

static bool is_past(uint32_t then_us, uint32_t now_us, uint32_t span_us) {
    return hal_clock_span_us(then_us, now_us) >= span_us;
}

/// Takes in what the driver says.
static void look(struct rig_buses *buses, struct rig_bus *bus) {
    struct rig_bus_condition *condition = &bus->condition;
    struct hal_can_state state;
    if (!rig_bus_is_at_hand(buses, bus) || hal_can_state(bus->hal, &state) != HAL_OK) {
        return;
    }
    if (state.health == HAL_CAN_OFF && condition->health != HAL_CAN_OFF) {
        condition->went_off = true;
        buses->offs++;
    }
    if (state.health == HAL_CAN_OFF) {
        condition->off = *rig_bus_error(bus); // which may turn into why it can't be restarted
    }
    condition->health = state.health;
    condition->frames_lost += state.lost_count - condition->lost_count;
    buses->frames_lost += state.lost_count - condition->lost_count;
    condition->lost_count = state.lost_count;
}

static enum rig_bus_trouble trouble_of(const struct rig_bus_condition *condition, uint32_t now_us) {
    if (condition->health == HAL_CAN_OFF || condition->went_off) {
        return RIG_BUS_OFF;
    }
    if (condition->refused >= RIG_BUS_FULL_TRIES &&
        is_past(condition->refused_since_us, now_us, RIG_BUS_FULL_US)) {
        return RIG_BUS_FULL;
    }
    return condition->health == HAL_CAN_PASSIVE ? RIG_BUS_PASSIVE : RIG_BUS_WELL;
}

static void describe(const struct rig_bus *bus, enum rig_bus_trouble trouble,
                     struct linux_error *line) {
    switch (trouble) {
    case RIG_BUS_OFF:
        *line = bus->condition.off;
        break;
    case RIG_BUS_FULL:
        linux_error_set(line, bus->text, "takes no frames, nobody on the bus acknowledges", REMEDY);
        break;
    case RIG_BUS_PASSIVE:
        linux_error_set(line, bus->text, "error-passive, many frames fail", REMEDY);
        break;
    default:
        snprintf(line->line, sizeof line->line, "%s: the bus works again", bus->text);
        break;
    }
}

/// Whether what is wrong with it has changed: the line is in condition->line then.
static bool trouble_is_new(struct rig_bus *bus, uint32_t now_us, bool *severe) {
    struct rig_bus_condition *condition = &bus->condition;
    const enum rig_bus_trouble trouble = trouble_of(condition, now_us);
    struct linux_error line = {.line = ""};
    if (trouble == RIG_BUS_WELL && condition->told == RIG_BUS_WELL) {
        return false;
    }
    describe(bus, trouble, &line);
    const bool same = trouble == condition->told && !condition->went_off &&
                      strcmp(line.line, condition->line.line) == 0;
    if (same || (condition->any_told && !is_past(condition->told_us, now_us, RIG_BUS_NEWS_US))) {
        return false;
    }
    condition->went_off = false;
    condition->any_told = true;
    condition->told_us = now_us;
    condition->told = trouble;
    condition->line = line;
    *severe = trouble != RIG_BUS_WELL;
    return true;
}

static bool loss_is_new(struct rig_bus *bus, uint32_t now_us) {
    struct rig_bus_condition *condition = &bus->condition;
    if (condition->frames_lost == condition->lost_told ||
        (condition->any_lost_told &&
         !is_past(condition->lost_told_us, now_us, RIG_BUS_LOST_NEWS_US))) {
        return false;
    }
    condition->any_lost_told = true;
    condition->lost_told_us = now_us;
    condition->lost_told = condition->frames_lost;
    return true;
}

const char *rig_buses_news(struct rig_buses *buses, bool *severe) {
    const uint32_t now_us = hal_clock_now_us(buses->clock);
    for (unsigned i = 0; i < buses->count; i++) {
        look(buses, &buses->bus[i]);
    }
    for (unsigned i = 0; i < buses->count; i++) {
        struct rig_bus *bus = &buses->bus[i];
        if (bus->lost) {
            continue;
        }
        if (trouble_is_new(bus, now_us, severe)) {
            return bus->condition.line.line;
        }
        if (loss_is_new(bus, now_us)) {
            snprintf(buses->error.line, sizeof buses->error.line,
                     "%s: %u frames came damaged, or faster than they were read", bus->text,
                     (unsigned)bus->condition.frames_lost);
            *severe = true;
            return buses->error.line;
        }
    }
    return NULL;
}

#include "scenario_event.h"

#include <stddef.h>
#include <stdlib.h>

static const char *const actions[] = {"arm", "stop", "pan", NULL};
static const uint32_t action_commands[] = {COMMAND_ARM, COMMAND_STOP, 0};
static const char *const paths[] = {"sum", "angle", NULL}; // enum pan_path

#define EVENT(member) .offset = offsetof(struct scenario_event, member)
const struct ini_key scenario_event_keys[SCENARIO_EVENT_KEY_COUNT] = {
    {.name = "at_s",
     .type = INI_DECIMAL,
     .min = "0",
     .max = "4000000",
     .numerator = 1000000,
     EVENT(at_us),
     .help = "when"},
    {.name = "do",
     .type = INI_CHOICE,
     .choices = actions,
     EVENT(action),
     .help = "what; pan: turn to an object"},
    {.name = "object",
     .type = INI_WHOLE,
     .fallback = "-1",
     .min = "-1",
     .max = "65535",
     EVENT(object),
     .help = "pan: to it; -1: to all"},
    {.name = "seconds",
     .type = INI_DECIMAL,
     .fallback = "2",
     .min = "0",
     .max = "3600",
     .numerator = 1000000,
     EVENT(duration_us),
     .help = "pan: how long it takes"},
    {.name = "path",
     .type = INI_CHOICE,
     .fallback = "sum",
     .choices = paths,
     EVENT(path),
     .help = "pan: weights of the directions, or parts of the way"},
};

static int compare_commands(const void *a, const void *b) {
    const struct sim_command *x = a, *y = b;
    return (x->at_us > y->at_us) - (x->at_us < y->at_us);
}

void scenario_read_events(const struct scenario_event *events, uint32_t count,
                          struct sim_command *commands) {
    for (uint32_t i = 0; i < count; i++) {
        const struct scenario_event *from = &events[i];
        commands[i] = (struct sim_command){
            .at_us = (uint64_t)from->at_us,
            .commands = action_commands[from->action],
            .pan_set = action_commands[from->action] == 0U,
            .pan = {.choice = {from->object >= 0, (uint16_t)(from->object & UINT16_MAX)},
                    .duration_us = (uint32_t)from->duration_us,
                    .path = (enum pan_path)from->path}};
    }
    qsort(commands, count, sizeof *commands, compare_commands);
}

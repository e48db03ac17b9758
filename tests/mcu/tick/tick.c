/// Counts the instructions of a control tick with a full set of targets, re-aimed in every tick.
///
/// Linked from the very objects of a board's image, with drives, pins and console of its own that
/// cost next to nothing. Runs under QEMU (meter.h). Prints `tick SCENE COUNT`, of the most
/// expensive tick of each, or why there is none. tests/gate/tick.sh has the limits.
#include "app/board_loop.h"
#include "compiled_rig.h"
#include "drive/rmd.h"
#include "mcu/tick/meter.h"
#include "posts.h"

int main(void);

// ---------------------------------------------------------------- devices

static uint32_t now_us_value;

static uint32_t now_us(void *ctx) {
    (void)ctx;
    return now_us_value;
}

/// A bus with drives that are where they were told to be, and answer everything at once.
#define REPLIES 8U
static struct can_frame reply[REPLIES];
static uint32_t reply_put, reply_taken;
static int32_t angle_cdeg[RMD_ID_MAX + 1U];

static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    (void)ctx;
    struct can_frame *answer = &reply[reply_put++ % REPLIES];
    const uint32_t id = frame->id - 0x140U;
    *answer = *frame;
    answer->id = frame->id + RMD_REPLY_OFFSET_V3;
    const uint32_t word = (uint32_t)frame->data[4] | (uint32_t)frame->data[5] << 8 |
                          (uint32_t)frame->data[6] << 16 | (uint32_t)frame->data[7] << 24;
    switch (frame->data[0]) {
    case RMD_POSITION:
        angle_cdeg[id] = (int32_t)word;
        break;
    case RMD_READ_ANGLE:
        for (unsigned i = 0; i < 4U; i++) {
            answer->data[4U + i] = (uint8_t)((uint32_t)angle_cdeg[id] >> 8U * i);
        }
        break;
    default:
        break;
    }
    return HAL_OK;
}

static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    (void)ctx;
    if (reply_taken == reply_put) {
        return HAL_EMPTY;
    }
    *frame = reply[reply_taken++ % REPLIES];
    *received_us = now_us_value;
    return HAL_OK;
}

static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    (void)ctx;
    *state = (struct hal_can_state){.health = HAL_CAN_ACTIVE};
    return HAL_OK;
}

static enum hal_status can_set_filters(void *ctx, const struct hal_can_filter *filters,
                                       uint32_t count) {
    (void)ctx, (void)filters, (void)count;
    return HAL_OK;
}

static enum hal_status can_restart(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static enum hal_status pwm_limits(void *ctx, uint32_t channel, struct hal_pwm_limits *limits) {
    (void)ctx, (void)channel;
    *limits = (struct hal_pwm_limits){20000000, 20000000, 20000000, 500};
    return HAL_OK;
}

static enum hal_status pwm_set(void *ctx, uint32_t channel, uint32_t ns) {
    (void)ctx, (void)channel, (void)ns;
    return HAL_OK;
}

static enum hal_status gpio_read(void *ctx, uint32_t line, bool *active) {
    (void)ctx, (void)line;
    *active = false;
    return HAL_OK;
}

static enum hal_status gpio_write(void *ctx, uint32_t line, bool active) {
    (void)ctx, (void)line, (void)active;
    return HAL_OK;
}

static enum hal_status serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                    size_t *written_bytes) {
    (void)ctx, (void)data;
    *written_bytes = size_bytes;
    return HAL_OK;
}

static enum hal_status serial_read(void *ctx, uint8_t *data, size_t capacity_bytes,
                                   size_t *read_bytes) {
    (void)ctx, (void)data, (void)capacity_bytes;
    *read_bytes = 0;
    return HAL_EMPTY;
}

static enum hal_status serial_state(void *ctx, struct hal_serial_state *state) {
    (void)ctx;
    *state = (struct hal_serial_state){0, 0};
    return HAL_OK;
}

static enum hal_status watchdog_start(void *ctx, uint32_t timeout_us) {
    (void)ctx, (void)timeout_us;
    return HAL_OK;
}

static enum hal_status watchdog_feed(void *ctx) {
    (void)ctx;
    return HAL_OK;
}

static enum hal_status watchdog_reset_cause(void *ctx, enum hal_reset_cause *cause) {
    (void)ctx;
    *cause = HAL_RESET_POWER_ON;
    return HAL_OK;
}

static const struct hal_clock_ops clock_ops = {now_us};
static const struct hal_can_ops can_ops = {can_send, can_receive, can_state, can_set_filters,
                                           can_restart};
static const struct hal_pwm_ops pwm_ops = {pwm_limits, pwm_set, pwm_set};
static const struct hal_gpio_ops gpio_ops = {gpio_read, gpio_write};
static const struct hal_serial_ops serial_ops = {serial_write, serial_read, serial_state};
static const struct hal_watchdog_ops watchdog_ops = {watchdog_start, watchdog_feed,
                                                     watchdog_reset_cause};
static const struct hal_clock hal_clock = {&clock_ops, NULL};
static const struct hal_can can = {&can_ops, NULL};
static const struct hal_pwm pwm = {&pwm_ops, NULL};
static const struct hal_gpio gpio = {&gpio_ops, NULL};
static const struct hal_serial serial = {&serial_ops, NULL};
static const struct hal_watchdog watchdog = {&watchdog_ops, NULL};

// ---------------------------------------------------------------- the scenes

/// How far out targets lie, in front of a gimbal that looks south, and how they move. Lengths in
/// micrometres.
struct scene {
    const char *name;
    int32_t spread_um; ///< to either side, of a plane 20 m ahead
    int32_t step_um;   ///< of each target, a report, in a random direction that it keeps
    uint32_t radius_um;
    bool ring;        ///< all near one circle, so that who is outermost changes all the time
    uint32_t reports; ///< a tick
    bool rect;        ///< frames a picture, not a cone
    bool above;       ///< overhead, where a turn of the pan rolls the picture
    bool rests;       ///< nothing moves: all the ticks of the search are counted
    bool pans;        ///< all the time, from one half of them to the other and back
    bool hides;       ///< posts stand before them: with each tick goes a unit of looking at that
};

/// A serial line of 115,200 baud carries 11.5 characters a tick, and a report has six at least.
#define LINE_REPORTS 2U

/// Every fourth target may be hidden: as many as OCCLUSION_TARGETS_MAX. They are told of first.
#define HIDDEN_EVERY 4U
_Static_assert(TARGET_CAPACITY / HIDDEN_EVERY == OCCLUSION_TARGETS_MAX, "or others are taken");

/// With one more the controller would wait for the rest of a frame.
#define FULL_REPORTS (CONTROLLER_UPDATES_MAX - 1U)

static const struct scene scenes[] = {
    {.name = "crowd", .spread_um = 8000000, .step_um = 6000, .reports = LINE_REPORTS},
    {.name = "wide", .spread_um = 80000000, .step_um = 40000, .reports = LINE_REPORTS},
    {.name = "narrow", .spread_um = 30000, .step_um = 20, .reports = LINE_REPORTS},
    {.name = "ring", .spread_um = 8000000, .step_um = 3000, .ring = true, .reports = LINE_REPORTS},
    {.name = "radii",
     .spread_um = 8000000,
     .step_um = 6000,
     .radius_um = 250000,
     .reports = LINE_REPORTS},
    {.name = "burst", .spread_um = 8000000, .step_um = 6000, .reports = FULL_REPORTS},
    {.name = "jumps",
     .spread_um = 8000000,
     .step_um = 4000000,
     .ring = true,
     .reports = FULL_REPORTS},
    {.name = "hard",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS},
    {.name = "rect", .spread_um = 8000000, .step_um = 6000, .reports = LINE_REPORTS, .rect = true},
    {.name = "rect-radii",
     .spread_um = 8000000,
     .step_um = 6000,
     .radius_um = 250000,
     .reports = LINE_REPORTS,
     .rect = true},
    {.name = "rect-above",
     .spread_um = 8000000,
     .step_um = 6000,
     .ring = true,
     .reports = LINE_REPORTS,
     .rect = true,
     .above = true},
    {.name = "rect-jumps",
     .spread_um = 8000000,
     .step_um = 4000000,
     .ring = true,
     .reports = FULL_REPORTS,
     .rect = true,
     .above = true},
    {.name = "rect-hard",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS,
     .rect = true,
     .above = true},
    {.name = "rect-rest",
     .spread_um = 20000000,
     .radius_um = 250000,
     .ring = true,
     .rect = true,
     .above = true,
     .rests = true},
    {.name = "pan", .spread_um = 8000000, .step_um = 6000, .reports = LINE_REPORTS, .pans = true},
    {.name = "pan-hard",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS,
     .pans = true},
    {.name = "pan-rect",
     .spread_um = 8000000,
     .step_um = 6000,
     .reports = LINE_REPORTS,
     .rect = true,
     .pans = true},
    {.name = "pan-rect-hard",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS,
     .rect = true,
     .pans = true},
    {.name = "hidden",
     .spread_um = 8000000,
     .step_um = 6000,
     .radius_um = 250000,
     .reports = LINE_REPORTS,
     .hides = true},
    {.name = "hidden-hard",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS,
     .hides = true},
    {.name = "hidden-rect",
     .spread_um = 8000000,
     .step_um = 4000000,
     .radius_um = 250000,
     .ring = true,
     .reports = FULL_REPORTS,
     .rect = true,
     .hides = true},
};
_Static_assert(TARGET_CAPACITY == 256U, "the budgets are those of 256 targets");

#define AHEAD_UM   INT64_C(20000000)
#define WARM_TICKS 1500U // after a second the lens is taken to be at home
#define TICKS      250U

static struct board_loop loop;
static struct vec3_i64 position_um[TARGET_CAPACITY], step_um[TARGET_CAPACITY];
static uint64_t random_state;

/// -most to most.
static int64_t random_within(int32_t most) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return (int64_t)((random_state >> 32) * (2U * (uint64_t)most + 1U) >> 32) - most;
}

static struct vec3_i64 add(struct vec3_i64 a, struct vec3_i64 b) {
    return (struct vec3_i64){a.x + b.x, a.y + b.y, a.z + b.z};
}

static void place_targets(const struct scene *scene) {
    random_state = UINT64_C(0x9E3779B97F4A7C15);
    for (uint32_t i = 0; i < TARGET_CAPACITY; i++) {
        int64_t x = random_within(scene->spread_um), z = random_within(scene->spread_um);
        if (scene->ring) { // onto the circle, but for a thousandth
            const struct vec3 unit = vec3_i64_normalise((struct vec3_i64){x, 0, z});
            const int64_t size = scene->spread_um + random_within(scene->spread_um / 1000);
            x = unit.x * size >> 30;
            z = unit.z * size >> 30;
        }
        const int64_t dx = random_within(scene->step_um), dz = random_within(scene->step_um);
        const struct vec3_i64 ahead = {x, -AHEAD_UM, z}, above = {x, z, AHEAD_UM};
        position_um[i] = add(compiled_rig.position_um, scene->above ? above : ahead);
        step_um[i] = scene->above ? (struct vec3_i64){dx, dz, 0} : (struct vec3_i64){dx, 0, dz};
    }
}

static bool report_targets(const struct scene *scene, uint32_t count, uint32_t step,
                           uint32_t *next) {
    for (uint32_t i = 0; i < count; i++, *next = (*next + step) % TARGET_CAPACITY) {
        position_um[*next] = add(position_um[*next], step_um[*next]);
        const struct target_update update = {.kind = TARGET_POSITION,
                                             .id = 1000U + *next,
                                             .object = (uint16_t)(*next % 2U),
                                             .weight_q16 = TARGET_WEIGHT_ONE_Q16,
                                             .position_um = position_um[*next],
                                             .radius_um = scene->radius_um};
        if (!pump_push(&loop.pump, &update)) {
            return false;
        }
    }
    return true;
}

// ---------------------------------------------------------------- what hides them

static uint32_t unit_most, units;

/// What a board does behind each tick at least; the rest of the tick is for more of it, which is
/// done here so that looks go on, and is measured by itself.
static uint32_t look(void) {
    const uint32_t start = meter_now();
    pump_occlusion_step(&posts.stage, &loop.pump);
    (void)occlusion_work(&posts.occlusion, posts.stage.time_us);
    const uint32_t count = meter_between(start, meter_now()) - meter_overhead;
    for (uint32_t i = 0; i < 20U; i++) {
        const uint32_t begun = meter_now();
        const bool more = occlusion_work(&posts.occlusion, posts.stage.time_us);
        const uint32_t unit = meter_between(begun, meter_now()) - meter_overhead;
        unit_most = unit > unit_most ? unit : unit_most;
        units += more;
    }
    return count;
}

static void start_loop(const struct scene *scene) {
    static const char *const no_notes[] = {NULL};
    static struct controller_config controller;
    static const struct board_config config = {.controller = &controller, .notes = no_notes};
    controller = compiled_rig;
    controller.frame = scene->rect ? CONTROLLER_FRAME_RECT : CONTROLLER_FRAME_CONE;
    reply_put = reply_taken = 0;
    board_loop_init(&loop, &config,
                    &(struct board_devices){.pump = {.clock = &hal_clock, .can = &can, .pwm = &pwm},
                                            .gpio = &gpio,
                                            .console = &serial,
                                            .watchdog = &watchdog});
    pump_command(&loop.pump, COMMAND_ARM);
}

#define PAN_TICKS 60U // and a pan takes 50 ms

static void start_pan(uint32_t tick) {
    const struct controller_pan pan = {
        .choice = {.one_object = true, .object = (uint16_t)(tick / PAN_TICKS % 2U)},
        .duration_us = 50000,
        .path = PAN_BY_ANGLE};
    pump_pan(&loop.pump, &pan);
}

/// Why the scene was not measured, or NULL.
static const char *run(const struct scene *scene, uint32_t *most) {
    start_loop(scene);
    if (scene->hides && !posts_set_up(&loop.pump, compiled_rig.position_um)) {
        return "no posts";
    }
    place_targets(scene);
    uint32_t next = 0;
    *most = 0;
    for (uint32_t tick = 0; tick < WARM_TICKS + TICKS; tick++) {
        const uint32_t solved = loop.controller.aims_solved;
        const bool warm = tick >= WARM_TICKS;
        now_us_value += compiled_rig.tick_us;
        const bool picks = scene->hides && tick < OCCLUSION_TARGETS_MAX;
        const uint32_t since = scene->hides ? tick - OCCLUSION_TARGETS_MAX : tick;
        const bool first = !picks && since * CONTROLLER_UPDATES_MAX < TARGET_CAPACITY;
        const uint32_t reports = picks   ? 1U
                                 : first ? CONTROLLER_UPDATES_MAX
                                 : warm  ? scene->reports
                                         : 0U;
        if (!report_targets(scene, reports, picks ? HIDDEN_EVERY : 1U, &next)) {
            return "reports are left over";
        }
        if (warm && scene->pans && tick % PAN_TICKS == 0U) {
            start_pan(tick);
        }
        const uint32_t start = meter_now();
        board_loop_tick(&loop, 0);
        const uint32_t tick_count = meter_between(start, meter_now()) - meter_overhead;
        const uint32_t count = tick_count + (scene->hides ? look() : 0U);
        if (warm && loop.pump.output.status.target_count != TARGET_CAPACITY) {
            return "targets are missing";
        }
        if (warm && loop.pump.output.status.mode != MODE_TRACKING) {
            return controller_mode_name(loop.pump.output.status.mode);
        }
        if (warm && !scene->rests && !scene->hides && loop.controller.aims_solved == solved) {
            return "nothing was aimed";
        }
        const bool counts = warm || (scene->rests && tick > 100U);
        *most = counts && count > *most ? count : *most;
    }
    return NULL;
}

int main(void) {
    if (!meter_start()) {
        meter_say("error", "the emulator does not count 1000 instructions as such but",
                  meter_count_loop());
        return 1;
    }
    for (unsigned i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        uint32_t most;
        const char *why = run(&scenes[i], &most);
        if (why != NULL) {
            meter_say("error", scenes[i].name, i);
            meter_say("error", why, i);
            return 1;
        }
        meter_say("tick", scenes[i].name, most);
    }
    if (units < 1000U || posts.occlusion.hidden_total == 0U) {
        meter_say("error", "nothing was looked at", units);
        return 1;
    }
    meter_say("tick", "look-unit", unit_most);
    return 0;
}

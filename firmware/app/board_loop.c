#include "app/board_loop.h"

/// Of the request of drive 0 (drive/rmd.h); a reply comes at an offset from that.
#define RMD_REQUEST_ID 0x140U

// ---------------------------------------------------------------- start

static void refuse(struct board_loop *loop, bool refused, const char *why) {
    if (refused && loop->status.refusal == NULL) {
        loop->status.refusal = why;
    }
}

/// Only the drives of the settings are listened to: access to the bus is no way into the board.
static bool set_filters(const struct board_loop *loop) {
    struct hal_can_filter filters[AXIS_COUNT];
    uint32_t count = 0;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct drive_config *drive = &loop->config->controller->axis[axis].drive;
        if (drive->kind == DRIVE_RMD) {
            filters[count++] = (struct hal_can_filter){
                .id = RMD_REQUEST_ID + drive->rmd.id + drive->rmd.reply_offset,
                .id_mask = CAN_FRAME_STANDARD_ID_MAX,
                .flags = 0,
                .flags_mask = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE};
        }
    }
    return loop->devices.pump.can == NULL ||
           hal_can_set_filters(loop->devices.pump.can, filters, count) == HAL_OK;
}

void board_loop_init(struct board_loop *loop, const struct board_config *config,
                     const struct board_devices *devices) {
    loop->config = config;
    loop->devices = *devices;
    loop->status = (struct board_status){.refusal = config->refusal};
    loop->checked_in = loop->ticks = 0;
    loop->enabled = false;
    loop->last_now_us = hal_clock_now_us(devices->pump.clock);
    if (hal_watchdog_reset_cause(devices->watchdog, &loop->status.reset_cause) != HAL_OK) {
        loop->status.reset_cause = HAL_RESET_UNKNOWN;
    }
    board_settings_init(&loop->settings, config->controller);
    refuse(loop, !controller_init(&loop->controller, &loop->settings.now),
           "the settings are not valid");
    loop->pump.output = (struct controller_output){0}; // told before the first tick
    loop->runs = pump_init(&loop->pump, &loop->controller, &devices->pump);
    refuse(loop, !loop->runs, "a device that the drives need is missing");
    refuse(loop, !set_filters(loop), "the CAN filters can't be set");
    loop->pump.input.now_us = loop->last_now_us;
    board_console_init(&loop->console, devices->console, config->notes, &loop->pump, &loop->status,
                       &loop->settings);
    refuse(loop, hal_watchdog_start(devices->watchdog, BOARD_WATCHDOG_US) != HAL_OK,
           "the watchdog does not start");
}

// ---------------------------------------------------------------- one tick

/// The name of the first stop line that is active, or that can't be read.
static const char *active_stop_line(const struct board_loop *loop) {
    for (uint32_t i = 0; i < loop->config->stop_line_count; i++) {
        const struct board_stop_line *stop = &loop->config->stop_lines[i];
        bool active = true;
        if (hal_gpio_read(loop->devices.gpio, stop->line, &active) != HAL_OK || active) {
            return stop->name;
        }
    }
    return NULL;
}

static void look_at_inputs(struct board_loop *loop) {
    const enum hal_reset_cause cause = loop->status.reset_cause;
    const bool after_crash =
        loop->ticks == 0U && (cause == HAL_RESET_WATCHDOG || cause == HAL_RESET_SOFTWARE);
    loop->status.stop = active_stop_line(loop);
    if (loop->status.stop != NULL || loop->status.refusal != NULL || after_crash) {
        pump_command(&loop->pump, COMMAND_STOP); // wins over an arm command of the same tick
    }
    loop->checked_in |= BOARD_TASK_INPUTS;
}

/// Are axes driven in this mode? A gimbal that stopped holds its position, so that takes power,
/// too.
static bool is_driving(const struct controller_status *status) {
    return status->mode >= MODE_SETTLING && (status->faults & FAULT_CONFIG) == 0U;
}

static void control(struct board_loop *loop) {
    if (!loop->runs) {
        loop->pump.input.now_us = hal_clock_now_us(loop->devices.pump.clock);
    } else {
        pump_step(&loop->pump);
    }
    const bool enable = is_driving(&loop->pump.output.status);
    if (enable != loop->enabled &&
        hal_gpio_write(loop->devices.gpio, loop->config->enable_line, enable) == HAL_OK) {
        loop->enabled = enable;
    }
    if (loop->pump.input.now_us != loop->last_now_us) {
        loop->last_now_us = loop->pump.input.now_us;
        loop->checked_in |= BOARD_TASK_CONTROL;
    }
}

/// A bus that is off and back again within a second must not look healthy on the console.
static void look_at_bus(struct board_loop *loop) {
    struct hal_can_state state, *worst = &loop->status.can;
    if (hal_can_state(loop->devices.pump.can, &state) != HAL_OK) {
        state = (struct hal_can_state){.health = HAL_CAN_OFF};
    }
    if (state.health > worst->health ||
        (state.health == worst->health &&
         (state.transmit_error_count > worst->transmit_error_count ||
          state.receive_error_count > worst->receive_error_count))) {
        *worst = state;
    }
}

static void talk(struct board_loop *loop) {
    if (loop->devices.pump.can != NULL) {
        look_at_bus(loop);
    }
    board_console_poll(&loop->console);
    loop->checked_in |= BOARD_TASK_CONSOLE;
}

static void feed_watchdog(struct board_loop *loop) {
    if (loop->checked_in == BOARD_TASKS) {
        loop->checked_in = 0;
        (void)!hal_watchdog_feed(loop->devices.watchdog);
    }
}

void board_loop_tick(struct board_loop *loop, uint32_t missed) {
    loop->status.ticks_missed += missed;
    look_at_inputs(loop);
    control(loop);
    talk(loop);
    feed_watchdog(loop);
    loop->ticks++;
    loop->status.busy_us =
        hal_clock_span_us(loop->pump.input.now_us, hal_clock_now_us(loop->devices.pump.clock));
    if (loop->status.busy_us > loop->status.busy_us_max) {
        loop->status.busy_us_max = loop->status.busy_us;
    }
}

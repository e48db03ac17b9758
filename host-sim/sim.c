#include "sim.h"

#include "sim_private.h"
#include "world/trace_hash.h"

#include <stdlib.h>
#include <string.h>

/// A number of its own for each random thing, so that one more device does not shift the others.
static uint64_t derive_seed(uint64_t seed, uint64_t purpose) {
    return trace_hash_u64(trace_hash_u64(TRACE_HASH_START, seed), purpose);
}

static void observe_frame(void *context, const struct can_transfer *transfer) {
    struct sim *sim = context;
    uint64_t data;
    memcpy(&data, transfer->frame.data, sizeof data);
    sim->hash = trace_hash_u64(sim->hash, transfer->end_ns);
    sim->hash = trace_hash_u64(
        sim->hash, ((uint64_t)transfer->frame.id << 32) | ((uint64_t)transfer->frame.flags << 16) |
                       ((uint64_t)transfer->frame.length << 8) | (uint64_t)transfer->fate);
    sim->hash = trace_hash_u64(sim->hash, data);
    sim_check_frame(sim, transfer);
}

/// Wires an actuator up as the rig file describes it, with physics of its own.
static bool build_axis(struct sim *sim, unsigned axis) {
    const struct drive_config *settings = &sim->config.controller->axis[axis].drive;
    struct sim_axis *built = &sim->axis[axis];
    const double start_deg = sim->config.start_deg[axis];
    built->kind = settings->kind;
    if (settings->kind == DRIVE_RMD) {
        const struct drive_rmd_config *rmd = &settings->rmd;
        const struct axis_plant_config plant =
            axis == AXIS_PAN ? axis_plant_pan() : axis_plant_tilt();
        struct rmd_drive_config drive = rmd_drive_defaults(rmd->id);
        drive.lktech = rmd->reply_offset == 0U;
        drive.zero_cdeg = (int32_t)drive_cdeg_from_q48(rmd->zero_q48);
        const double motor_deg = rmd->reversed ? -start_deg : start_deg;
        axis_plant_init(&built->plant, &plant, motor_deg * AXIS_PLANT_PI / 180.0);
        return rmd_drive_init(&built->drive, &drive, &built->plant, &sim->bus,
                              derive_seed(sim->config.seed, 10U + axis));
    }
    const struct pwm_servo_config servo = pwm_servo_defaults();
    pwm_servo_init(&built->servo, &servo, start_deg, 0, derive_seed(sim->config.seed, 20U + axis));
    return true;
}

/// A lens that does what the rig file says of it, on a servo with limits of its own.
static void build_lens(struct sim *sim) {
    const struct controller_config *controller = sim->config.controller;
    const struct drive_config *drive = &controller->axis[AXIS_ZOOM].drive;
    struct zoom_lens_config lens = zoom_lens_defaults();
    if (drive->kind == DRIVE_PWM) {
        const double centre_ns = lens.servo.pulse_ns_centre;
        lens.wide_deg = (drive->pwm.low_pulse_ns - centre_ns) * 1e-3 * lens.servo.deg_per_us;
        lens.tele_deg = (drive->pwm.high_pulse_ns - centre_ns) * 1e-3 * lens.servo.deg_per_us;
        for (unsigned i = 0; i < ZOOM_LENS_POINTS; i++) {
            const int64_t position_q48 = AXIS_TURN_Q48 / (ZOOM_LENS_POINTS - 1) * i;
            lens.focal_mm[i] = lens_focal_at_um(&controller->lens, position_q48) / 1000.0;
        }
    }
    zoom_lens_init(&sim->lens, &lens, 0, derive_seed(sim->config.seed, 3));
}

/// The controller's end of everything: its pump, or a board.
static bool build_controller(struct sim *sim) {
    const struct sim_board *board = sim->config.board;
    sim->own_node = sim->bus.node_count;
    if (board != NULL) {
        if (sim->config.controller->arm_on_start) {
            board->command(board->context, COMMAND_ARM); // the board's own settings may say no
        }
        return board->attach(board->context, sim);
    }
    recorder_start(sim->config.recorder, sim->config.controller);
    const struct pump_devices devices = {&sim->clock, &sim->node.hal, &sim->pwm};
    return bus_node_hal_init(&sim->node, &sim->bus, sim->config.start_us) && sim_hal_bind(sim) &&
           pump_init(&sim->pump, &sim->controller, &devices);
}

struct sim *sim_create(const struct sim_config *config) {
    struct sim *sim = calloc(1, sizeof *sim);
    if (sim == NULL) {
        return NULL;
    }
    sim->config = *config;
    sim->random = derive_seed(config->seed, 1) | 1U;
    sim->hash = TRACE_HASH_START;
    can_bus_init(&sim->bus, 1000000, derive_seed(config->seed, 2));
    can_bus_set_loss(&sim->bus, config->can_loss);
    sim->bus.observer = observe_frame;
    sim->bus.observer_context = sim;
    build_lens(sim);
    // Two memories with different garbage: what a controller reads before it writes shows up as a
    // difference.
    memset(&sim->controller, 0x00, sizeof sim->controller);
    memset(&sim->shadow, 0xA5, sizeof sim->shadow);
    (void)controller_init(&sim->controller, config->controller);
    (void)controller_init(&sim->shadow, config->controller);
    const bool built =
        build_controller(sim) && build_axis(sim, AXIS_PAN) && build_axis(sim, AXIS_TILT);
    sim_check_init(sim);
    sim_measure_init(sim);
    if (!built || !sim_world_init(sim)) {
        sim_destroy(sim);
        return NULL;
    }
    return sim;
}

void sim_destroy(struct sim *sim) {
    if (sim != NULL) {
        free(sim->measure.errors_deg);
        free(sim->occlusion_workspace);
        free(sim);
    }
}

// ---------------------------------------------------------------- the world, for a tick

/// Gaussian, near enough for a measurement error: the sum of twelve uniform numbers.
static double noise(struct sim *sim) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        sim->random ^= sim->random >> 12;
        sim->random ^= sim->random << 25;
        sim->random ^= sim->random >> 27;
        sum += (double)((sim->random * UINT64_C(0x2545F4914F6CDD1D)) >> 11) * 0x1p-53;
    }
    return sum;
}

static int64_t blur_um(struct sim *sim, int64_t value_um, double deviation_m) {
    return deviation_m > 0.0 ? value_um + (int64_t)(noise(sim) * deviation_m * 1e6) : value_um;
}

/// To the pump, or to the board.
static bool give_controller(struct sim *sim, const struct target_update *update) {
    const struct sim_board *board = sim->config.board;
    return board != NULL ? board->push(board->context, update) : pump_push(&sim->pump, update);
}

/// By way of what may hide it.
static bool give(struct sim *sim, const struct target_update *update) {
    return sim_world_take(sim, update) || give_controller(sim, update);
}

static void command(struct sim *sim, uint32_t commands) {
    const struct sim_board *board = sim->config.board;
    if (board != NULL) {
        board->command(board->context, commands);
    } else {
        pump_command(&sim->pump, commands);
    }
}

/// The truth is that of where the pan goes.
static void start_pan(struct sim *sim, const struct controller_pan *pan) {
    const struct sim_board *board = sim->config.board;
    if (board != NULL) {
        board->pan(board->context, pan);
    } else {
        pump_pan(&sim->pump, pan);
    }
    sim_measure_choose(sim, pan->choice);
}

/// Does the controller hear of the targets as they are?
static bool hears_all(const struct sim *sim) {
    return sim->config.camera == NULL && !sim->served.on;
}

static void move_targets(struct sim *sim) {
    const struct schedule *schedule = sim->config.schedule;
    for (size_t i = 0; i < schedule->mover_count; i++) {
        const struct schedule_mover *mover = &schedule->movers[i];
        const bool alive = sim->time_us >= mover->from_us &&
                           (mover->until_us == 0U || sim->time_us < mover->until_us);
        struct target_update update = {.kind = TARGET_POSITION,
                                       .id = mover->id,
                                       .object = mover->object,
                                       .weight_q16 = TARGET_WEIGHT_ONE_Q16};
        if (!alive) {
            if (mover->until_us != 0U && sim->time_us == mover->until_us) {
                update.kind = TARGET_GONE;
                (void)sim_push(sim, &update);
            }
            continue;
        }
        update.position_um = schedule_mover_position_um(mover, sim->time_us);
        sim_measure_update(sim, &update);
        if (hears_all(sim) && (sim->time_us - mover->from_us) % mover->period_us == 0U) {
            update.position_um.x = blur_um(sim, update.position_um.x, mover->noise_m);
            update.position_um.y = blur_um(sim, update.position_um.y, mover->noise_m);
            update.position_um.z = blur_um(sim, update.position_um.z, mover->noise_m);
            (void)give(sim, &update); // a full queue is counted by the pump
        }
    }
}

bool sim_hear(struct sim *sim, const struct target_update *update) {
    return give(sim, update);
}

bool sim_push(struct sim *sim, const struct target_update *update) {
    if (hears_all(sim) && !give(sim, update)) {
        return false;
    }
    sim_measure_update(sim, update);
    return true;
}

void sim_feed_targets(struct sim *sim) {
    const struct schedule *schedule = sim->config.schedule;
    while (sim->next_item < schedule->item_count &&
           schedule->items[sim->next_item].at_us <= sim->time_us &&
           sim_push(sim, &schedule->items[sim->next_item].update)) {
        sim->next_item++;
    }
    move_targets(sim);
}

static void feed(struct sim *sim) {
    sim_feed_targets(sim);
    sim_world_step(sim);
    while (sim->next_command < sim->config.command_count &&
           sim->config.commands[sim->next_command].at_us <= sim->time_us) {
        const struct sim_command *next = &sim->config.commands[sim->next_command++];
        command(sim, next->commands);
        if (next->pan_set) {
            start_pan(sim, &next->pan);
        }
    }
}

/// Gives each servo the pulses of its channel.
static void drive_servos(struct sim *sim) {
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        const struct drive_config *drive = &sim->config.controller->axis[axis].drive;
        if (drive->kind != DRIVE_PWM) {
            continue;
        }
        const uint32_t pulse_ns = sim->pulse_ns[drive->pwm.channel % SIM_PWM_CHANNELS];
        pwm_servo_set_pulse(axis == AXIS_ZOOM ? &sim->lens.servo : &sim->axis[axis].servo,
                            pulse_ns);
    }
}

void sim_run_plant(struct sim *sim, uint64_t until_ns) {
    can_bus_run_until(&sim->bus, until_ns);
    for (unsigned axis = 0; axis < 2U; axis++) {
        if (sim->axis[axis].kind == DRIVE_RMD) {
            rmd_drive_advance(&sim->axis[axis].drive, until_ns);
            sim->hash = rmd_drive_hash(&sim->axis[axis].drive, sim->hash);
            sim->hash = axis_plant_hash(&sim->axis[axis].plant, sim->hash);
        } else {
            pwm_servo_advance(&sim->axis[axis].servo, until_ns);
            sim->hash = pwm_servo_hash(&sim->axis[axis].servo, sim->hash);
        }
    }
    pwm_servo_advance(&sim->lens.servo, until_ns);
    sim->hash = pwm_servo_hash(&sim->lens.servo, sim->hash);
}

/// After a step of the controller, wherever it ran.
static void look_at_step(struct sim *sim) {
    controller_step(&sim->shadow, &sim->pump.input, &sim->shadow_output);
    sim_check_step(sim);
    recorder_tick(sim->config.recorder, &sim->pump.input, &sim->pump.output);
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        sim->hash = trace_hash_u64(sim->hash, sim->pump.output.pulse_ns[axis]);
    }
    sim->hash = trace_hash_u64(sim->hash, sim->tick);
}

void sim_board_start(struct sim *sim, const struct controller_config *config) {
    (void)controller_init(&sim->shadow, config);
    sim_check_init_axes(sim);
    recorder_start(sim->config.recorder, config);
}

void sim_board_tick(struct sim *sim, const struct sim_board_tick *tick) {
    sim->pump.input = *tick->input;
    sim->pump.output = *tick->output;
    sim->controller.mode = tick->output->status.mode;
    sim->controller.faults = tick->output->status.faults;
    for (unsigned axis = 0; axis < AXIS_COUNT; axis++) {
        sim->controller.powered[axis] = tick->powered[axis];
        sim->controller.ever_powered[axis] = tick->ever_powered[axis];
    }
    look_at_step(sim);
}

void sim_step(struct sim *sim) {
    const struct sim_board *board = sim->config.board;
    const uint32_t tick_us = sim->config.controller->tick_us;
    feed(sim);
    if (sim->config.camera != NULL) {
        sim->config.camera->step(sim->config.camera->context, sim);
    }
    if (board != NULL) {
        board->run(board->context, (sim->time_us + tick_us) * 1000U);
    } else {
        pump_step(&sim->pump);
        sim_world_heard(sim);
        look_at_step(sim);
    }
    drive_servos(sim);
    sim_run_plant(sim, (sim->time_us + tick_us) * 1000U);
    if (sim->time_us % 10000U == 0U) {
        sim_measure_step(sim);
    }
    sim->time_us += tick_us;
    sim->tick++;
}

double sim_joint_deg(const struct sim *sim, unsigned axis) {
    const struct sim_axis *built = &sim->axis[axis];
    if (built->kind != DRIVE_RMD) {
        return built->servo.angle_deg;
    }
    const double motor_deg = built->plant.angle_rad * 180.0 / AXIS_PLANT_PI;
    return sim->config.controller->axis[axis].drive.rmd.reversed ? -motor_deg : motor_deg;
}

/// The simulator: the firmware's pump and controller on a simulated gimbal, in virtual time.
///
/// A tick: due target updates go to the pump; the pump runs the controller; the invariants are
/// checked; then the bus, the drives and the plant run to the next tick. The controller sees frames
/// and sends pulses, nothing else. A second controller, in memory filled with another pattern, gets
/// the same inputs and must give the same outputs. Deterministic by seed: every frame, pulse and
/// plant state goes into the trace hash.
#ifndef SIM_H
#define SIM_H

#include "app/pump.h"
#include "app/pump_occlusion.h"
#include "devices/bus_node_hal.h"
#include "devices/can_bus.h"
#include "devices/pwm_servo.h"
#include "devices/rmd_drive.h"
#include "plant/axis_plant.h"
#include "replay/recording.h"
#include "world/schedule.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// ---------------------------------------------------------------- what to simulate

/// A command at a time, of a scenario's [event] sections.
struct sim_command {
    uint64_t at_us;
    uint32_t commands; ///< enum controller_command
    bool pan_set;
    struct controller_pan pan;
};

struct sim;

/// What runs the controller instead of the simulator's own pump: an emulated board
/// (mcu/mcu_board.h). It is switched on at time 0, keeps its own time, and tells of each tick of
/// its controller by sim_board_start and sim_board_tick.
struct sim_board {
    /// Puts the board's CAN controller on sim->bus. False: the bus is full.
    bool (*attach)(void *context, struct sim *sim);
    /// What sim_push and commands would give to the pump.
    bool (*push)(void *context, const struct target_update *update);
    void (*command)(void *context, uint32_t commands);
    void (*pan)(void *context, const struct controller_pan *pan);
    /// Runs board and bus, and sets sim->pulse_ns to what comes out of its servo outputs.
    void (*run)(void *context, uint64_t until_ns);
    void *context;
};

/// Solids between the camera and its targets, in groups that move alike. What the controller hears
/// goes through occlusion first: in the pump, or before a board hears of it. With OCCLUSION_IGNORE
/// they stand in the pictures and hide nothing.
struct sim_obstacles {
    struct occlusion_config occlusion;
    uint32_t group_count;
    struct {
        double start_m[3], velocity_mps[3];
    } group[OCCLUSION_GROUPS_MAX];
};

/// What the controller hears of the targets from, instead of from the schedule: a camera on the
/// gimbal. It looks at the truth (sim_observe, sim->measure.truth) and tells by sim_hear.
struct sim_camera {
    /// Before each step of the controller.
    void (*step)(void *context, struct sim *sim);
    void *context;
};

struct sim_config {
    const struct controller_config *controller;
    const struct schedule *schedule;
    const struct sim_command *commands; ///< ascending in time
    size_t command_count;
    uint64_t seed;
    uint32_t start_us;                     ///< of the controller's clock: 0xFFFF0000 tests its wrap
    double can_loss;                       ///< probability that a frame is lost
    double start_deg[2];                   ///< pan and tilt at power-on
    double fixed_focal_mm;                 ///< of the camera when there is no zoom axis
    const struct sim_board *board;         ///< NULL: the simulator runs the controller
    const struct sim_camera *camera;       ///< NULL: the controller hears of every target
    const struct sim_obstacles *obstacles; ///< NULL: nothing hides anything
    struct recorder *recorder; ///< gets every tick's input and output; NULL: nobody does
};

// ---------------------------------------------------------------- what it found

enum sim_invariant {
    SIM_I1_POSITION,
    SIM_I2_RATES,
    SIM_I4_UNARMED_MOTION,
    SIM_I5_SAME_BITS,
    SIM_I9_RESUME,
    SIM_INVARIANT_COUNT
};

/// How the last check of an invariant failed, for a person.
struct sim_violations {
    uint64_t count[SIM_INVARIANT_COUNT];
    uint64_t first_us; ///< time of the first of all
    char first[160];   ///< what it was
};

/// Errors are measured while tracking, 100 times a second, from the time the aim has settled (error
/// first below 0.1 degree) until the optimal aim jumps by more than 5 degrees.
struct sim_summary {
    double seconds;
    uint32_t targets; ///< most at one time
    uint64_t steps;
    uint64_t trace_hash;
    double aim_error_rms_deg, aim_error_p99_deg, aim_error_max_deg;
    double in_frame_percent; ///< of all (target, moment) pairs while tracking
    double hidden_percent;   ///< of all looks at what hides targets
    double settle_s;         ///< mean time from a jump of the aim (or arming) to settled
    uint64_t settle_count;
    double bus_load_percent;
    struct sim_violations violations;
    struct pump_errors errors;
};

// ---------------------------------------------------------------- inside

/// The truth about one axis and its actuator.
struct sim_axis {
    enum drive_kind kind;
    struct axis_plant plant; ///< RMD
    struct rmd_drive drive;  ///< RMD
    struct pwm_servo servo;  ///< PWM pan or tilt
};

/// What the invariants remember of an axis from tick to tick.
struct sim_axis_check {
    int64_t setpoint_q48, speed_q48, accel_q48;
    bool powered;
    uint32_t restarts;
    uint32_t ticks; ///< since it was powered, up to 3: how many differences mean something
};

struct sim_measure {
    struct target_set truth;
    struct framing framing;
    struct framing_workspace workspace;
    struct framing_choice choice; ///< what the last pan went to
    uint32_t framed_version;
    bool settled, timing;
    uint64_t aim_changed_us, settled_us;
    double settle_sum_s;
    uint64_t settle_count;
    double *errors_deg;
    size_t error_count, error_capacity;
    uint64_t seen, looked_at; ///< (target, moment) pairs
    uint32_t most_targets;
};

/// A moment as measured; see sim_observe.
struct sim_view {
    double pan_deg, tilt_deg, focal_mm;
    double error_deg;                         ///< negative: nothing to aim at
    bool settled;                             ///< since the last jump
    struct vec3 right_q30, ahead_q30, up_q30; ///< of the camera, world axes
};

/// The bridge of sim_serve_step.
struct sim_served {
    bool on;
    uint64_t frames_in, frames_out;
    uint64_t frames_lost; ///< one of the two buses refused them
    bool has_next;        ///< came in and waits for the simulated bus
    struct can_frame next;
};

#define SIM_PWM_CHANNELS 64U

struct sim {
    struct sim_config config;
    uint64_t time_us;
    uint64_t tick;
    struct controller controller, shadow;
    struct controller_output shadow_output;
    struct pump pump;
    struct hal_clock clock;
    struct hal_pwm pwm;
    struct can_bus bus;
    struct bus_node_hal node; ///< the controller's end of the bus
    uint8_t own_node;         ///< its index there, or that of the board
    struct sim_axis axis[2];
    struct zoom_lens lens;
    uint32_t pulse_ns[SIM_PWM_CHANNELS]; ///< as the PWM channels give them
    struct sim_served served;
    size_t next_item, next_command;
    bool item_waiting;
    uint64_t random;
    uint64_t hash;
    struct sim_axis_check check[AXIS_COUNT];
    struct sim_violations violations;
    struct sim_measure measure;
    struct occlusion occlusion;
    void *occlusion_workspace; ///< NULL: none
    struct pump_occlusion hiding;
};

// ---------------------------------------------------------------- use

/// A simulation at time 0. NULL: out of memory, or more drives than the bus takes. config and what
/// it points to must outlive it. An unusable controller configuration is simulated as well: it
/// never arms.
struct sim *sim_create(const struct sim_config *config);
void sim_destroy(struct sim *sim);

/// One tick.
void sim_step(struct sim *sim);

/// For a controller elsewhere, in place of sim_step: one tick of the drives and the plant, whose
/// bus is bridged to another. The controller in here rests and hears of no target; the truth
/// follows schedule and sim_push, so that sim_observe tells how well the other aims. Position and
/// speed of the plant are checked. Not for PWM axes, which no bus reaches, nor with obstacles.
void sim_serve_step(struct sim *sim, const struct hal_can *outside);

/// Besides the schedule: an update for the next tick, from outside. False: the pump's queue is
/// full, try after a tick.
bool sim_push(struct sim *sim, const struct target_update *update);

/// From a camera: what it takes for a target. The truth stays as it is. False: as for sim_push.
bool sim_hear(struct sim *sim, const struct target_update *update);

/// From a board: its controller begins (again), with these settings, which must last.
void sim_board_start(struct sim *sim, const struct controller_config *config);

/// From a board: its controller took a step. The invariants are checked against what it put out,
/// and a controller of this build gets the same input and must put out the same.
struct sim_board_tick {
    const struct controller_input *input;
    const struct controller_output *output;
    bool powered[AXIS_COUNT], ever_powered[AXIS_COUNT];
};
void sim_board_tick(struct sim *sim, const struct sim_board_tick *tick);

/// What a camera on the gimbal sees at this moment: the truth, which the controller does not know.
struct sim_view sim_observe(const struct sim *sim);

/// Where a group of obstacles is at a time, in micrometres.
struct vec3_i64 sim_group_offset_um(const struct sim_obstacles *obstacles, uint32_t group,
                                    uint64_t at_us);

/// True joint angle of pan or tilt.
double sim_joint_deg(const struct sim *sim, unsigned axis);

struct sim_summary sim_summarise(struct sim *sim);

/// Of all looks at targets, how many found one hidden as a whole.
double sim_hidden_percent(const struct occlusion *occlusion);

uint64_t sim_violation_count(const struct sim_violations *violations);
const char *sim_invariant_name(enum sim_invariant invariant);

#endif

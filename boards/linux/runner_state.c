#include "runner_state.h"

#include "degrees.h"
#include "state_line.h"

static const char *const names[AXIS_COUNT] = {"pan", "tilt", "zoom"};

static const char *fact_name(unsigned axis, const char *what) {
    static char name[32];
    snprintf(name, sizeof name, "%s_%s", names[axis], what);
    return name;
}

void runner_state_joints(const struct runner *runner, struct facts *facts) {
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        const struct controller_axis_status *at = &runner->pump->output.status.axis[axis];
        facts_fixed(facts, fact_name(axis, "deg"),
                    degrees(at->measured_known ? at->measured_q48 : at->setpoint_q48), 4);
    }
}

/// The angle of a pulse.
static double angle_of(const struct drive_pwm_config *pwm, uint32_t pulse_ns) {
    const double part = ((double)pulse_ns - (double)pwm->low_pulse_ns) /
                        ((double)pwm->high_pulse_ns - (double)pwm->low_pulse_ns);
    return degrees(pwm->low_q48) + part * degrees(pwm->high_q48 - pwm->low_q48);
}

void runner_state_servos(const struct runner *runner, struct facts *facts) {
    for (unsigned axis = 0; runner->sim == NULL && axis < AXIS_COUNT; axis++) {
        uint32_t pulse_ns = 0;
        bool known = false;
        if (!rig_devices_read_back(&runner->devices, axis, &known, &pulse_ns)) {
            continue;
        }
        if (!known || pulse_ns == 0U) {
            facts_null(facts, fact_name(axis, "servo_us"), "it gives no pulses");
            continue;
        }
        facts_fixed(facts, fact_name(axis, "servo_us"), pulse_ns * 1e-3, 2);
        if (axis != AXIS_ZOOM) {
            const struct drive_pwm_config *pwm = &runner->rig.controller.axis[axis].drive.pwm;
            facts_fixed(facts, fact_name(axis, "servo_deg"), angle_of(pwm, pulse_ns), 3);
        }
    }
}

// ---------------------------------------------------------------- lines

static void write_facts(const void *context, FILE *stream) {
    const struct runner *runner = context;
    const struct controller_status *status = &runner->pump->output.status;
    struct facts facts;
    facts_begin(&facts, stream, true);
    facts_fixed(&facts, "t_s", (double)(runner->loop.ticks * runner->loop.tick_us) * 1e-6, 3);
    facts_text(&facts, "mode", controller_mode_name(status->mode));
    runner_state_joints(runner, &facts);
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        facts_fixed(&facts, fact_name(axis, "goal_deg"), degrees(status->axis[axis].goal_q48), 4);
    }
    runner_state_servos(runner, &facts);
    facts_u64(&facts, "targets", status->target_count);
    if (runner->camera.eye != NULL) {
        facts_bool(&facts, "camera", camera_feed_is_there(&runner->camera.feed));
        facts_u64(&facts, "camera_frames", runner->camera.feed.frames);
    }
    facts_end(&facts);
}

void runner_state_tick(struct runner *runner) {
    const uint64_t now_us = runner->loop.ticks * runner->loop.tick_us;
    if (runner->settings.state_us == 0U || now_us < runner->state_due_us) {
        return;
    }
    runner->state_due_us = now_us + runner->settings.state_us;
    runner->states_dropped += state_line_print(write_facts, runner) ? 0U : 1U;
}

#include "run_board_private.h"

#include "facts.h"
#include "sim.h"
#include "state_line.h"

#include <math.h>
#include <stdlib.h>

extern const char build_id[];

void run_board_measure(struct board_run *run) {
    const struct board_link_status *status = &run->link.status;
    double apart[2];
    bool jumped = status->mode != MODE_TRACKING;
    for (unsigned axis = 0; axis < 2U; axis++) {
        const int32_t at =
            status->measured[axis] ? status->measured_mdeg[axis] : status->setpoint_mdeg[axis];
        apart[axis] = (double)(status->goal_mdeg[axis] - at) / 1000.0;
        jumped = jumped || abs(status->goal_mdeg[axis] - run->goal_mdeg[axis]) > 5000;
        run->goal_mdeg[axis] = status->goal_mdeg[axis];
    }
    apart[0] *= cos((double)status->goal_mdeg[1] / 1000.0 * 3.14159265358979 / 180.0);
    const double error = sqrt(apart[0] * apart[0] + apart[1] * apart[1]);
    run->settled = !jumped && (run->settled || error < 0.1);
    if (run->settled) {
        run->error_sum += error * error;
        run->error_count++;
    }
}

// ---------------------------------------------------------------- now and then

static void write_state(const void *context, FILE *stream) {
    static const char *const at_names[] = {"pan_deg", "tilt_deg"};
    static const char *const goal_names[] = {"pan_goal_deg", "tilt_goal_deg"};
    const struct board_run *run = context;
    const struct board_link_status *status = &run->link.status;
    struct facts facts;
    facts_begin(&facts, stream, true);
    facts_fixed(&facts, "t_s", (double)(run->loop.ticks * run->loop.tick_us) * 1e-6, 3);
    facts_bool(&facts, "board", run->is_there);
    if (run->is_there && run->link.status_count != 0U) {
        facts_text(&facts, "mode", controller_mode_name(status->mode));
        for (unsigned axis = 0; axis < 2U; axis++) {
            facts_fixed(
                &facts, at_names[axis],
                (status->measured[axis] ? status->measured_mdeg : status->setpoint_mdeg)[axis] /
                    1000.0,
                3);
        }
        for (unsigned axis = 0; axis < 2U; axis++) {
            facts_fixed(&facts, goal_names[axis], status->goal_mdeg[axis] / 1000.0, 3);
        }
        facts_u64(&facts, "targets", status->targets);
    }
    facts_end(&facts);
}

void run_board_state(struct board_run *run, uint64_t now_us) {
    if (run->options->state_us == 0U || now_us < run->state_due_us) {
        return;
    }
    run->state_due_us = now_us + run->options->state_us;
    run->states_dropped += state_line_print(write_state, run) ? 0U : 1U;
}

// ---------------------------------------------------------------- in the end

void run_board_summary(struct board_run *run) {
    const struct board_link *link = &run->link;
    const struct board_link_status *status = &link->status;
    const uint64_t now_us = event_loop_now_us();
    uint64_t board_us = 0, error_us = 0;
    (void)!board_clock_read(&link->clock, now_us, &board_us, &error_us);
    struct facts facts;
    facts_begin(&facts, stdout, run->options->json);
    facts_text(&facts, "build", build_id);
    facts_text(&facts, "board", run->rig->board_device);
    facts_text(&facts, "board_build", link->identity.build);
    facts_u64(&facts, "board_returns", run->returns);
    facts_text(&facts, "mode", controller_mode_name(status->mode));
    facts_fixed(&facts, "seconds", (double)(now_us - run->start_us) * 1e-6, 3);
    facts_u64(&facts, "targets", run->targets.most);
    facts_fixed(&facts, "hidden_percent",
                run->hiding != NULL ? sim_hidden_percent(&run->hiding->occlusion) : 0.0, 2);
    facts_u64(&facts, "bad_lines",
              run->options->source != NULL ? run->options->source->bad_lines : 0U);
    facts_u64(&facts, "updates_rejected", status->rejected + run->targets_refused);
    facts_u64(&facts, "log_dropped", run_log_dropped(&run->log));
    if (run->options->state_us != 0U) {
        facts_u64(&facts, "states_dropped", run->states_dropped);
    }
    facts_fixed(&facts, "pan_deg", status->setpoint_mdeg[0] / 1000.0, 3);
    facts_fixed(&facts, "tilt_deg", status->setpoint_mdeg[1] / 1000.0, 3);
    const double count = run->error_count != 0U ? (double)run->error_count : 1.0;
    facts_fixed(&facts, "aim_error_rms_deg", sqrt(run->error_sum / count), 4);
    facts_u64(&facts, "status_lines", link->status_count);
    facts_u64(&facts, "status_gap_ms_max", link->gap_us_max / 1000U);
    facts_u64(&facts, "target_lines_sent", link->target_lines_sent);
    facts_u64(&facts, "lines_taken", status->taken);
    facts_u64(&facts, "lines_damaged", status->damaged + link->splitter.damaged);
    facts_u64(&facts, "lines_stale", status->stale);
    facts_u64(&facts, "frames_compact", run->targets.compact_frames);
    facts_u64(&facts, "frames_cut", run->targets.cut_frames);
    facts_u64(&facts, "clock_answers", link->clock.answers);
    facts_fixed(&facts, "clock_error_ms", (double)error_us * 1e-3, 3);
    facts_end(&facts);
}

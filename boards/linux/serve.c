#include "serve.h"

#include "event_loop.h"
#include "facts.h"

#include "linux/linux_can.h"
#include "linux/linux_clock.h"

#include <errno.h>
#include <string.h>

/// The simulation keeps up with the clock, but not with a gap: after a long one (a stopped process)
/// it goes on from where it was.
#define CATCH_UP_TICKS_MAX 1000U

static void print_summary(const struct sim *sim, const struct event_loop *loop, bool as_json) {
    struct facts facts;
    facts_begin(&facts, stdout, as_json);
    facts_fixed(&facts, "seconds", (double)sim->time_us * 1e-6, 3);
    facts_u64(&facts, "steps", sim->tick);
    facts_u64(&facts, "late_us_max", loop->jitter.max);
    facts_u64(&facts, "frames_in", sim->served.frames_in);
    facts_u64(&facts, "frames_out", sim->served.frames_out);
    facts_u64(&facts, "frames_lost", sim->served.frames_lost);
    facts_fixed(&facts, "pan_deg", sim_joint_deg(sim, AXIS_PAN), 4);
    facts_fixed(&facts, "tilt_deg", sim_joint_deg(sim, AXIS_TILT), 4);
    facts_u64(&facts, "violations", sim_violation_count(&sim->violations));
    facts_end(&facts);
}

static bool on_bus_only(const struct scenario *scenario) {
    for (unsigned axis = AXIS_PAN; axis <= AXIS_TILT; axis++) {
        if (scenario->rig.controller.axis[axis].drive.kind != DRIVE_RMD) {
            message_at(scenario->rig.ini.file, 0,
                       "has a hobby servo for pan or tilt, which no bus reaches");
            return false;
        }
    }
    return true;
}

static enum exit_status loop_until(struct event_loop *loop, struct sim *sim,
                                   const struct linux_can *can, double seconds) {
    struct hal_can_state state;
    uint32_t raised = 0;
    while ((raised & EVENT_LOOP_END) == 0U &&
           (seconds <= 0.0 || (double)sim->time_us * 1e-6 < seconds)) {
        uint64_t due = event_loop_tick(loop, &raised);
        due = due > CATCH_UP_TICKS_MAX ? CATCH_UP_TICKS_MAX : due;
        for (uint64_t i = 0; i < due; i++) {
            sim_serve_step(sim, &can->hal);
        }
        if (hal_can_state(&can->hal, &state) == HAL_ERROR_GONE) {
            return EXIT_STATUS_DEVICE;
        }
    }
    return EXIT_STATUS_OK;
}

enum exit_status serve_drives(const char *command, struct scenario *scenario, const char *bus,
                              double seconds, bool as_json) {
    if (strncmp(bus, "can:", 4) != 0) {
        message_command(command, "--serve '%s': give can:NAME, as can:vcan0", bus);
        return EXIT_STATUS_USAGE;
    }
    if (!on_bus_only(scenario)) {
        return EXIT_STATUS_USAGE;
    }
    struct linux_clock clock;
    struct linux_can can;
    linux_clock_open(&clock, 0);
    if (linux_can_open(&can, bus + 4, &clock.hal) != HAL_OK) {
        message_command(command, "%s", can.error.line);
        return EXIT_STATUS_DEVICE;
    }
    struct event_loop loop;
    struct sim *sim = sim_create(&scenario->sim);
    enum exit_status status = EXIT_STATUS_FAILURE;
    if (!event_loop_open(&loop, scenario->rig.controller.tick_us) || sim == NULL) {
        message_command(command, "can't start: %s", strerror(errno));
    } else {
        status = loop_until(&loop, sim, &can, seconds);
        if (status == EXIT_STATUS_DEVICE) {
            message_command(command, "%s", can.error.line);
        } else if (sim_violation_count(&sim->violations) != 0U) {
            message_command(command, "invariant violated at %.3f s: %s",
                            (double)sim->violations.first_us * 1e-6, sim->violations.first);
            status = EXIT_STATUS_FAILURE;
        }
        print_summary(sim, &loop, as_json);
    }
    event_loop_close(&loop);
    sim_destroy(sim);
    linux_can_close(&can);
    return status;
}

/// `boresight sim --serve can:NAME`: the drives of a scenario's rig, in real time, on a CAN
/// interface, for a controller in another process or on another board; and what the camera on that
/// gimbal sees, so that the other finds its targets itself.
///
/// The truth, which nobody else knows, is told by lines of state: where the axes really are and how
/// far the camera looks past the optimal axis of the targets as they really are.
/// Shown: tests/vm/guest/run.sh, tests/vm/guest/loop.sh.
#ifndef LINUX_SERVE_H
#define LINUX_SERVE_H

#include "command.h"
#include "scenario.h"

struct serve_options {
    const char *bus;     ///< can:NAME
    const char *frames;  ///< as for frame_out_open; NULL: none
    const char *targets; ///< a stream, besides the scenario's; NULL: none
    double seconds;      ///< 0: until interrupted
    double state_s;      ///< a line of state every so often; 0: none
    bool as_json;
};

enum exit_status serve_drives(const char *command, struct scenario *scenario,
                              const struct serve_options *options);

#endif

/// `boresight sim --serve can:NAME`: the drives of a scenario's rig, in real time, on a CAN
/// interface, for a controller in another process or on another board.
#ifndef LINUX_SERVE_H
#define LINUX_SERVE_H

#include "command.h"
#include "scenario.h"

/// bus: can:NAME. seconds: 0: until interrupted.
enum exit_status serve_drives(const char *command, struct scenario *scenario, const char *bus,
                              double seconds, bool as_json);

#endif

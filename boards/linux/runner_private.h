/// The parts of a runner: runner.c has the loop, runner_rig.c the rig. For them only.
#ifndef LINUX_RUNNER_PRIVATE_H
#define LINUX_RUNNER_PRIVATE_H

#include "runner.h"

/// As run_log_tell.
void runner_tell(struct runner *runner, bool severe, const char *event, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// How often devices that are missing are looked for.
#define RUNNER_LOOK_EVERY_US 500000U

/// Controller and devices of runner->rig. EXIT_STATUS_DEVICE: runner->refusal is why.
enum exit_status runner_build(struct runner *runner);
/// After a build that did not come to be: tells which device it was, unless that was told. True: it
/// will be tried again, in runner_reload_tick; until then no controller runs. False: that is the
/// end.
bool runner_waits(struct runner *runner, enum exit_status status) MUST_CHECK;
void runner_dismantle(struct runner *runner);

/// What hides the targets of a rig, as occlusion_rig_open has it.
enum exit_status runner_read_hiding(const struct runner *runner, const struct rig *rig,
                                    struct occlusion_rig **out);
/// What was read for a reload is not used.
void runner_drop_next(struct runner *runner);

/// Is every powered axis at rest?
bool runner_stands_still(const struct runner *runner);

/// Does time pass as fast as it can? A real camera would not keep up.
bool runner_is_hurried(const struct runner *runner);

/// SIGHUP: reads the file again, in the background. Where only its camera differs that is changed
/// at once; else all comes to rest, and then everything begins anew with the rig that was read: it
/// has to be homed, and armed, as at the start. A file that can't be used changes nothing.
void runner_begin_reload(struct runner *runner);

/// At every tick. While runner->rebuilding, devices and controller belong to the background: then
/// nothing else is due in a tick. Sets runner->status if the new devices can't be used, or the wait
/// for them is to end.
void runner_reload_tick(struct runner *runner);
void runner_forget_camera_rigs(struct runner *runner);

#endif

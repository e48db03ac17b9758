/// The devices that a rig file names, opened: what the pump reads and writes when nothing is
/// simulated.
///
/// Buses are those of rig_bus.h. `device = pwmchipN` is a PWM chip of the kernel's,
/// `device = maestro` (or maestro:SERIAL) a USB servo controller; with `drive = uvc` it is a
/// camera, by its path or name. `device = gpio:CHIP` are plain lines, for servos (channel: the
/// line) and with `drive = step` for stepper drivers (channel: STEP). `fake` outputs next to real
/// devices go nowhere. A device that leaves while the rig runs answers HAL_ERROR_GONE;
/// rig_devices_mend opens it again when it is back, and outputs get the pulses that were asked for
/// last. A camera that refuses a setting is asked again, and taken for lost when it refuses for two
/// seconds.
///
/// Opening takes long, a USB device up to seconds, so what was lost is opened in the background: no
/// tick waits for it. Until then it belongs to the background alone.
/// Shown: tests/scenario/test_rig_devices.c (Maestro, camera and lines that leave and return),
/// tests/scenario/test_rig_mend.c (an adapter whose opening blocks).
#ifndef LINUX_RIG_DEVICES_H
#define LINUX_RIG_DEVICES_H

#include "message.h"
#include "refusals.h"
#include "rig.h"
#include "rig_bus.h"
#include "side_job.h"

#include "app/pump.h"
#include "linux/linux_camera.h"
#include "linux/linux_camera_servo.h"
#include "linux/linux_clock.h"
#include "linux/linux_gpio_pulses.h"
#include "linux/linux_gpio_steps.h"
#include "linux/linux_maestro.h"
#include "linux/linux_pwm.h"

#include <stdbool.h>

enum rig_output_kind {
    RIG_OUTPUT_PWM,
    RIG_OUTPUT_MAESTRO,
    RIG_OUTPUT_CAMERA,
    RIG_OUTPUT_GPIO,
    RIG_OUTPUT_STEPS
};

/// A device with outputs; several axes may share one.
struct rig_output_device {
    enum rig_output_kind kind;
    const char *text;
    uint32_t channels; ///< a bit each
    struct linux_pwm pwm;
    struct linux_maestro maestro;
    struct linux_camera camera;
    struct linux_camera_servo servo;
    struct linux_gpio_pulses pulses;
    uint32_t lines[AXIS_COUNT]; ///< of pulses
    uint32_t line_count;
    struct linux_gpio_steps steps;
    const struct rig_step *step; ///< NULL: no stepper driver
    struct hal_pwm step_hal;
    struct refusals refusals; ///< of the camera's settings
    const struct hal_pwm *hal;
    struct linux_error error; ///< why it could not be opened
    bool lost;                ///< not touched until it is opened anew
    bool mending, mended;     ///< the background is opening it; has opened it
};

/// How an axis' pulses come out.
struct rig_output {
    struct rig_output_device *device; ///< NULL: nowhere
    uint32_t channel;
    uint32_t pulse_ns;                   ///< as last asked for, for a device that comes back
    uint32_t pulse_ns_min, pulse_ns_max; ///< that its axis will ask for; of cameras
};

struct rig_devices {
    struct pump_devices pump;

    // Private from here on.
    struct linux_clock clock;
    struct rig_buses buses;
    struct rig_output_device device[AXIS_COUNT];
    unsigned device_count;
    struct hal_pwm outputs;
    struct rig_output output[AXIS_COUNT];
    struct linux_error error; ///< of the device that could not be opened, or was lost last
    struct side_job mending;
    bool mending_begun;
    bool bus_mending[RIG_BUSES_MAX], bus_mended[RIG_BUSES_MAX];
    uint32_t asked_us; ///< when Maestros were last asked where their outputs are
};

/// Opens them all. rig: its controller's PWM channels are numbered by axis from now on.
/// Returns: EXIT_STATUS_OK; EXIT_STATUS_DEVICE, and devices->error is the line for the person;
/// EXIT_STATUS_USAGE after a line on stderr. Nothing is left open then. Must not move in memory
/// afterwards.
enum exit_status rig_devices_open(struct rig_devices *devices, struct rig *rig);
void rig_devices_close(struct rig_devices *devices);

/// Moves what is under way on USB. At every tick.
void rig_devices_tick(struct rig_devices *devices);

/// How far edges on GPIO lines were off so far, in ns; count 0: there are none.
struct linux_jitter rig_devices_jitter(struct rig_devices *devices);

/// Looks whether a device has left since the last call. Returns its line, once for each loss; NULL:
/// none has.
const char *rig_devices_newly_lost(struct rig_devices *devices);
/// Is one missing now?
bool rig_devices_incomplete(const struct rig_devices *devices);
/// Tries to open what is missing, in the background, unless it is being tried. What comes of it is
/// taken up by a later rig_devices_tick. Twice a second is often enough.
void rig_devices_mend(struct rig_devices *devices);

/// The pulse that an axis' output gives now, as the device says (a Maestro, which may move slower
/// than it is told). False: this device says no such thing. *known: it has said so.
bool rig_devices_read_back(const struct rig_devices *devices, enum controller_axis axis,
                           bool *known, uint32_t *pulse_ns);

#endif

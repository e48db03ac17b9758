/// The outputs of a rig's axes on devices that the test plays below the libraries: a Maestro, a
/// camera that turns itself, a servo and a stepper on plain lines. They get what the axes ask for,
/// tell where they are, leave, and have it again when they are back.
#include "rig_devices.h"

#include "check.h"
#include "contract/support/libusb_model.h"
#include "contract/support/maestro_model.h"
#include "contract/support/syscalls.h"
#include "contract/support/v4l2_model.h"
#include "linux/linux_gpiod.h"

#include <errno.h>
#include <linux/videodev2.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if HAVE_LIBUSB && HAVE_GPIOD

static char folder[] = "/tmp/boresight-devices-XXXXXX";
static char rig_file[64];
static struct rig rig;
static struct rig_devices devices;
static struct linux_clock clock_;
static const char *camera_path;

// ---------------------------------------------------------------- the devices

static struct maestro_model maestro;

static int maestro_control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    if (setup[0] == 0x80U && setup[1] == 6U) {
        memcpy(data, maestro_model_device, sizeof maestro_model_device);
        return sizeof maestro_model_device;
    }
    return maestro_model_control(ctx, setup, data, size);
}
static const struct libusb_model maestro_usb = {.vendor = 0x1FFB,
                                                .product = 0x0089,
                                                .release_bcd = 0x0104,
                                                .serial_number = MAESTRO_MODEL_SERIAL,
                                                .ctx = &maestro,
                                                .control = maestro_control,
                                                .bulk_out = maestro_model_bulk_out,
                                                .bulk_in = maestro_model_bulk_in};

/// A chip whose line 4 is a servo's, 5 the STEP and 6 the DIR of a stepper driver.
enum { SERVO = 4, STEP = 5, DIRECTION = 6, LINES = 8 };
static struct line {
    unsigned number;
    bool held;
    atomic_bool high;
} line[LINES];
static atomic_bool chip_gone;
static atomic_uint pulses;     ///< of the servo
static atomic_int motor_steps; ///< where the motor is
static unsigned held_lines;

void *linux_gpiod_request(const char *chip, uint32_t offset, const struct hal_gpio_line *wanted,
                          enum linux_gpiod_step *step) {
    *step = strcmp(chip, "lines") != 0 || chip_gone ? LINUX_GPIOD_CHIP
            : offset >= LINES                       ? LINUX_GPIOD_LINE
                                                    : LINUX_GPIOD_REQUEST;
    errno = *step == LINUX_GPIOD_CHIP ? ENOENT : *step == LINUX_GPIOD_LINE ? EINVAL : EBUSY;
    if (*step != LINUX_GPIOD_REQUEST || line[offset].held) {
        return NULL;
    }
    line[offset].held = true;
    line[offset].number = offset;
    line[offset].high = wanted->initially_active;
    held_lines++;
    return &line[offset];
}

void linux_gpiod_release(void *context) {
    ((struct line *)context)->held = false;
    held_lines--;
}

int linux_gpiod_get(void *context) {
    return ((struct line *)context)->high;
}

int linux_gpiod_set(void *context, bool active) {
    struct line *const at = context;
    if (chip_gone) {
        errno = ENODEV;
        return -1;
    }
    const bool rises = active && !at->high;
    pulses += rises && at->number == SERVO;
    motor_steps += !rises || at->number != STEP ? 0 : line[DIRECTION].high ? 1 : -1;
    at->high = active;
    return 0;
}

bool linux_gpiod_consumer(const char *chip, uint32_t offset, char *name, size_t capacity) {
    (void)chip;
    (void)offset;
    snprintf(name, capacity, "somebody");
    return true;
}

bool linux_gpiod_describe(const char *path, struct linux_gpio_chip *chip) {
    (void)path;
    (void)chip;
    return false;
}

// ---------------------------------------------------------------- rigs

#define LIMITS "limit_min_deg = -60\nlimit_max_deg = 60\nspeed_max_dps = 90\naccel_max_dps2 = 360\n"
/// 1000 to 2000 us for -60 to 60 degrees.
#define SERVO_AXIS "drive = pwm\ncalibration_deg = -60, 60\ncalibration_us = 1000, 2000\n" LIMITS

static enum exit_status open_rig(const char *format, const char *pan, const char *tilt) {
    FILE *file = fopen(rig_file, "w");
    CHECK(file != NULL);
    fprintf(file, format, pan, tilt);
    CHECK_EQ(fclose(file), 0);
    CHECK_EQ(rig_read(rig_file, 0, &rig), EXIT_STATUS_OK);
    return rig_devices_open(&devices, &rig);
}

static void close_rig(void) {
    rig_devices_close(&devices);
    CHECK_EQ(libusb_model_objects(), 0);
    CHECK_EQ(held_lines, 0);
    rig_free(&rig);
}

/// What an axis asks for.
static enum hal_status ask(unsigned axis, uint32_t pulse_ns) {
    return hal_pwm_set_pulse(devices.pump.pwm, axis, pulse_ns);
}

/// Ticks until something has come true. False: it has not within half a minute.
static bool ticks_until(bool (*come)(void)) {
    for (unsigned i = 0; i < 30000U; i++) {
        rig_devices_tick(&devices);
        if (come()) {
            return true;
        }
        usleep(1000);
    }
    return false;
}

static const char *lost_line;
static bool is_lost(void) {
    lost_line = rig_devices_newly_lost(&devices);
    return lost_line != NULL;
}
static bool is_mended(void) {
    return !devices.mending_begun;
}

static void expect_loss(const char *device, const char *reason) {
    char line_[200];
    snprintf(line_, sizeof line_, "%s: %s", device, reason);
    CHECK(ticks_until(is_lost));
    if (!CHECK(lost_line != NULL && strncmp(lost_line, line_, strlen(line_)) == 0)) {
        printf("  told   %s\n  wanted %s\n", lost_line != NULL ? lost_line : "nothing", line_);
    }
}

/// No more than those losses, and those axes answer so.
static void expect_gone(unsigned first, unsigned last) {
    CHECK(!is_lost() && rig_devices_incomplete(&devices)); // told once
    for (unsigned axis = first; axis <= last; axis++) {
        struct hal_pwm_limits limits;
        CHECK_EQ(hal_pwm_limits(devices.pump.pwm, axis, &limits), HAL_ERROR_GONE);
        CHECK_EQ(hal_pwm_set_period(devices.pump.pwm, axis, 20000000), HAL_ERROR_GONE);
    }
}

static void mend(bool wanted) {
    rig_devices_mend(&devices);
    CHECK(devices.mending_begun && ticks_until(is_mended));
    CHECK_EQ(rig_devices_incomplete(&devices), !wanted);
}

static void expect_refusal(enum exit_status status, const char *wanted) {
    CHECK_EQ(status, EXIT_STATUS_DEVICE);
    if (!CHECK(strcmp(devices.error.line, wanted) == 0)) {
        printf("  told   %s\n  wanted %s\n", devices.error.line, wanted);
    }
    CHECK_EQ(libusb_model_objects(), 0);
    CHECK_EQ(held_lines, 0);
    rig_devices_close(&devices); // once more does no harm
    rig_free(&rig);
}

// ---------------------------------------------------------------- a Maestro

#define MAESTRO_RIG                                                                                \
    "[pan]\ndevice = %s\nchannel = 0\n" SERVO_AXIS "[tilt]\ndevice = %s\n" SERVO_AXIS              \
    "channel = 4\n[camera]\nfocal_mm = 4\n"

static bool targets_are_set(void) {
    return maestro.target[0] == 6000U && maestro.target[4] == 4400U;
}
static bool targets_are_set_again(void) {
    return maestro.target[0] == 7200U && maestro.target[4] == 4400U;
}
static uint32_t told_ns[2];
static bool told[2];
static bool positions_are_known(void) {
    bool all = true;
    for (unsigned axis = 0; axis < 2U; axis++) {
        CHECK(rig_devices_read_back(&devices, (enum controller_axis)axis, &told[axis],
                                    &told_ns[axis]));
        all = all && told[axis] && told_ns[axis] != 0U;
    }
    return all;
}

/// Both axes are outputs of one; 0.25 us a unit.
static void a_maestro_leaves_and_returns(void) {
    struct hal_pwm_limits limits;
    memset(&maestro, 0, sizeof maestro);
    libusb_model_plug(0, &maestro_usb);
    CHECK_EQ(open_rig(MAESTRO_RIG, "maestro", "maestro"), EXIT_STATUS_OK);
    CHECK_EQ(devices.device_count, 1);
    CHECK_EQ(ask(AXIS_PAN, 1500000), HAL_OK);
    CHECK_EQ(ask(AXIS_TILT, 1100000), HAL_OK);
    CHECK(ticks_until(targets_are_set));
    CHECK(ticks_until(positions_are_known));
    CHECK_EQ(told_ns[0], 1500000);
    CHECK_EQ(told_ns[1], 1100000);
    CHECK_EQ(hal_pwm_limits(devices.pump.pwm, AXIS_TILT, &limits), HAL_OK);
    CHECK_EQ(limits.resolution_ns, 250);
    // Zoom has no device: its pulses go nowhere. More axes than three there are not.
    CHECK_EQ(ask(AXIS_ZOOM, 1500000), HAL_OK);
    CHECK_EQ(hal_pwm_limits(devices.pump.pwm, AXIS_ZOOM, &limits), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_pwm_set_period(devices.pump.pwm, AXIS_ZOOM, 20000000), HAL_ERROR_ARGUMENT);
    CHECK_EQ(ask(AXIS_COUNT, 1500000), HAL_ERROR_ARGUMENT);
    CHECK_EQ(hal_pwm_limits(devices.pump.pwm, AXIS_COUNT, &limits), HAL_ERROR_ARGUMENT);
    CHECK(!rig_devices_read_back(&devices, AXIS_ZOOM, &told[0], &told_ns[0]));
    CHECK_EQ(rig_devices_jitter(&devices).count, 0);

    libusb_model_plug(0, NULL);
    expect_loss("Maestro 1ffb:0089", "the device has left; plug it in again");
    expect_gone(AXIS_PAN, AXIS_TILT);
    CHECK_EQ(ask(AXIS_PAN, 1800000), HAL_ERROR_GONE); // kept for its return
    CHECK(rig_devices_read_back(&devices, AXIS_PAN, &told[0], &told_ns[0]) && !told[0]);
    mend(false);
    mend(false);
    memset(&maestro, 0, sizeof maestro);
    libusb_model_plug(0, &maestro_usb);
    mend(true);
    CHECK(ticks_until(targets_are_set_again));
    CHECK(ticks_until(positions_are_known));
    CHECK_EQ(ask(AXIS_PAN, 1500000), HAL_OK);
    CHECK(ticks_until(targets_are_set));
    close_rig();
}

static void maestros_that_can_not_be_had(void) {
    libusb_model_plug(0, &maestro_usb);
    CHECK_EQ(open_rig(MAESTRO_RIG, "maestro:" MAESTRO_MODEL_SERIAL, "fake"), EXIT_STATUS_OK);
    CHECK(!rig_devices_read_back(&devices, AXIS_TILT, &told[0], &told_ns[0]));
    close_rig();
    expect_refusal(open_rig(MAESTRO_RIG, "maestro:" MAESTRO_MODEL_SERIAL, "maestro:99"),
                   "Maestro 99: no such USB device; is it plugged in? `boresight probe` lists what "
                   "is there");
    expect_refusal(open_rig("[pan]\ndevice = %s\nchannel = 6\n" SERVO_AXIS
                            "[tilt]\ndevice = %s\n" SERVO_AXIS
                            "channel = 4\n[camera]\nfocal_mm = 4\n",
                            "maestro", "maestro"),
                   "maestro: has no such channel; choose another channel in the rig file");
}

// ---------------------------------------------------------------- a camera that turns itself

#define UVC_AXIS "drive = uvc\ndevice = %s\nspeed_max_dps = 90\naccel_max_dps2 = 360\n"
#define UVC_RIG(pan_min, pan_max, tilt_min, tilt_max)                                              \
    "[pan]\n" UVC_AXIS "limit_min_deg = " pan_min "\nlimit_max_deg = " pan_max                     \
    "\n[tilt]\n" UVC_AXIS "limit_min_deg = " tilt_min "\nlimit_max_deg = " tilt_max                \
    "\n[camera]\nfocal_mm = 4\n"

static bool looks_there(void) {
    return v4l2_model_value(V4L2_CID_PAN_ABSOLUTE) == 36000 &&
           v4l2_model_value(V4L2_CID_TILT_ABSOLUTE) == -72000;
}
static bool looks_elsewhere(void) {
    return v4l2_model_value(V4L2_CID_PAN_ABSOLUTE) == -108000 &&
           v4l2_model_value(V4L2_CID_TILT_ABSOLUTE) == -72000;
}

/// Pulses of 10 ms and n ns are n arc-seconds.
static void a_camera_leaves_and_returns(void) {
    const uint32_t files = syscalls_open_files();
    v4l2_model_reset();
    CHECK_EQ(open_rig(UVC_RIG("-170", "180", "-90", "80"), camera_path, camera_path),
             EXIT_STATUS_OK);
    CHECK_EQ(devices.device_count, 1);
    CHECK_EQ(ask(AXIS_PAN, 10000000 + 36000), HAL_OK);
    CHECK_EQ(ask(AXIS_TILT, 10000000 - 72000), HAL_OK);
    CHECK(ticks_until(looks_there));
    CHECK(!rig_devices_read_back(&devices, AXIS_PAN, &told[0], &told_ns[0]));
    v4l2_model_unplug();
    (void)!ask(AXIS_PAN, 10000000 + 3600); // nothing but a setting tells that it has left
    expect_loss(camera_path, "the camera has left; plug it in again");
    expect_gone(AXIS_PAN, AXIS_TILT);
    CHECK_EQ(ask(AXIS_PAN, 10000000 - 108000), HAL_ERROR_GONE);
    mend(false);
    v4l2_model_reset();
    mend(true);
    CHECK(ticks_until(looks_elsewhere));
    close_rig();
    CHECK_EQ(syscalls_open_files(), files);
}

static bool is_refused(void) {
    return linux_camera_failed_settings(&devices.device[0].camera) >= 2U;
}

/// Both axes are asked for again, also if nothing else is.
static void a_refused_setting_is_sent_again(void) {
    v4l2_model_reset();
    CHECK_EQ(open_rig(UVC_RIG("-170", "180", "-90", "80"), camera_path, camera_path),
             EXIT_STATUS_OK);
    v4l2_model_faults.refuse = EIO;
    CHECK_EQ(ask(AXIS_PAN, 10000000 + 36000), HAL_OK);
    CHECK_EQ(ask(AXIS_TILT, 10000000 - 72000), HAL_OK);
    CHECK(ticks_until(is_refused));
    CHECK(!is_lost());
    v4l2_model_faults.refuse = 0;
    CHECK(ticks_until(looks_there));
    CHECK(!is_lost() && !rig_devices_incomplete(&devices));
    close_rig();
}

/// The model turns 180 degrees to either side, and 90 up and down.
static void axes_that_a_camera_does_not_have(void) {
    const uint32_t files = syscalls_open_files();
    char wanted[200];
    v4l2_model_reset();
    snprintf(wanted, sizeof wanted,
             "%s: its tilt goes from -90.00 to 90.00 degrees; set limit_min_deg and limit_max_deg",
             camera_path);
    expect_refusal(open_rig(UVC_RIG("-170", "170", "-91", "80"), camera_path, camera_path), wanted);
    expect_refusal(open_rig(UVC_RIG("-170", "170", "-80", "91"), camera_path, camera_path), wanted);
    static const char *const missing[] = {"pan", "tilt"};
    for (uint32_t i = 0; i < 2U; i++) {
        snprintf(wanted, sizeof wanted,
                 "%s: the camera has no %s of its own; `boresight probe` shows its axes",
                 camera_path, missing[i]);
        v4l2_model_reset();
        v4l2_model_faults.without = V4L2_CID_PAN_ABSOLUTE + i;
        expect_refusal(open_rig(UVC_RIG("-170", "170", "-80", "80"), camera_path, camera_path),
                       wanted);
    }
    v4l2_model_reset();
    expect_refusal(open_rig(UVC_RIG("-170", "170", "-80", "80"), "/dev/nocamera", "/dev/nocamera"),
                   "/dev/nocamera: no such file or device; is it plugged in? `boresight probe` "
                   "lists the cameras");
    CHECK_EQ(syscalls_open_files(), files);
}

// ---------------------------------------------------------------- plain lines

/// 10 steps a degree.
#define LINES_RIG                                                                                  \
    "[pan]\ndevice = %s\nchannel = 4\n" SERVO_AXIS "[tilt]\ndrive = step\ndevice = %s\n"           \
    "channel = 5\ndirection_channel = 6\nsteps_per_deg = 10\n" LIMITS "[camera]\nfocal_mm = 4\n"

static int wanted_steps;
static bool motor_is_there(void) {
    return motor_steps == wanted_steps;
}
static unsigned pulses_before;
static bool more_pulses(void) {
    return pulses >= pulses_before + 3U;
}

/// Tilt's pulses count steps from the lower limit; it stands at home, 0 degrees, at the start.
static void tilt_to(int deg) {
    const struct rig_step *step = &rig.step[AXIS_TILT];
    wanted_steps = deg * 10;
    CHECK_EQ(ask(AXIS_TILT, RIG_STEP_BASE_NS + (uint32_t)(deg + 60) * 10U * step->unit_ns), HAL_OK);
    if (!CHECK(ticks_until(motor_is_there))) {
        printf("  %d steps, not %d\n", motor_steps, wanted_steps);
    }
}

static void lines_of_a_chip_that_leaves(void) {
    motor_steps = 0;
    chip_gone = false;
    CHECK_EQ(open_rig(LINES_RIG, "gpio:lines", "gpio:lines"), EXIT_STATUS_OK);
    CHECK_EQ(devices.device_count, 2);
    CHECK_EQ(held_lines, 3);
    tilt_to(3);
    tilt_to(-2);
    CHECK_EQ(ask(AXIS_TILT, 0), HAL_OK); // no power: it stays
    CHECK_EQ(ask(AXIS_PAN, 1500000), HAL_OK);
    pulses_before = pulses;
    CHECK(ticks_until(more_pulses));
    CHECK(rig_devices_jitter(&devices).count > 0U);
    CHECK(motor_is_there());

    chip_gone = true;
    (void)!ask(AXIS_TILT, RIG_STEP_BASE_NS + 600U * rig.step[AXIS_TILT].unit_ns);
    expect_loss("lines", "the chip has gone"); // the servo's thread finds out by itself
    expect_loss("lines", "the chip has gone"); // and so does the stepper's
    expect_gone(AXIS_PAN, AXIS_TILT);
    mend(false);
    const int stays = motor_steps;
    CHECK_EQ(stays, -20);
    chip_gone = false;
    mend(true);
    pulses_before = pulses;
    CHECK(ticks_until(more_pulses)); // as it was asked to last
    tilt_to(0);                      // from where the motor is
    tilt_to(5);
    close_rig();
}

static void lines_that_can_not_be_had(void) {
    static const char wanted[] =
        "/dev/nochip: no such file or device; `boresight probe` lists the GPIO chips";
    chip_gone = false;
    expect_refusal(open_rig(LINES_RIG, "gpio:nochip", "gpio:lines"), wanted);
    expect_refusal(open_rig(LINES_RIG, "gpio:lines", "gpio:nochip"), wanted);
}

int main(void) {
    if (mkdtemp(folder) == NULL) {
        perror(folder);
        return 2;
    }
    snprintf(rig_file, sizeof rig_file, "%s/rig.ini", folder);
    linux_clock_open(&clock_, 0);
    camera_path = v4l2_model_plug(&clock_.hal);
    TEST(a_maestro_leaves_and_returns);
    TEST(maestros_that_can_not_be_had);
    TEST(a_camera_leaves_and_returns);
    TEST(a_refused_setting_is_sent_again);
    TEST(axes_that_a_camera_does_not_have);
    TEST(lines_of_a_chip_that_leaves);
    TEST(lines_that_can_not_be_had);
    (void)unlink(camera_path);
    (void)unlink(rig_file);
    (void)rmdir(folder);
    return check_finish();
}

#else

int main(void) {
    printf("SKIP rig_devices: built without libusb or libgpiod\n");
    return check_finish();
}

#endif

/// `boresight probe`: which devices a rig could use, and what to write into its file.
#include "command.h"
#include "json.h"

#include "linux/linux_camera.h"
#include "linux/linux_can.h"
#include "linux/linux_gpio.h"
#include "linux/linux_gs_usb.h"
#include "linux/linux_links.h"
#include "linux/linux_pwm.h"
#include "linux/linux_serial.h"
#include "linux/linux_usb.h"

#include <glob.h>
#include <string.h>
#include <unistd.h>

enum { DEVICES_MAX = 64, TEXT_BYTES = 160 };

struct settings {
    bool json;
};

static const struct option options[] = {OPTION_JSON(struct settings)};

/// A device, as it is told.
struct found {
    const char *kind;
    char name[64];
    char write[LINUX_SERIAL_PATH_BYTES + 16]; ///< what to write into a rig file
    char about[TEXT_BYTES];
    char first[TEXT_BYTES]; ///< what has to be done before; empty: nothing
};

static void print_found(const struct found *found, bool as_json) {
    if (!as_json) {
        printf("%-7s %-18s %-30s %s%s%s\n", found->kind, found->name, found->write, found->about,
               found->first[0] != '\0' ? "; first: " : "", found->first);
        return;
    }
    const char *const keys[] = {"kind", "name", "write", "about", "first"};
    const char *const values[] = {found->kind, found->name, found->write, found->about,
                                  found->first};
    struct json json;
    json_start(&json, stdout);
    json_begin_object(&json);
    for (unsigned i = 0; i < sizeof keys / sizeof *keys; i++) {
        json_key(&json, keys[i]);
        json_text(&json, values[i]);
    }
    json_end_object(&json);
    putchar('\n');
}

// ---------------------------------------------------------------- kinds

static void describe_can(const struct linux_can_link *link, struct found *found) {
    static const char *const health[] = {"active", "passive", "bus-off"};
    snprintf(found->name, sizeof found->name, "%.15s", link->name);
    snprintf(found->write, sizeof found->write, "bus = can:%.15s", link->name);
    if (!link->has_controller) {
        snprintf(found->about, sizeof found->about, "virtual");
    } else if (link->bitrate == 0U) {
        snprintf(found->about, sizeof found->about, "no bit rate");
    } else {
        snprintf(found->about, sizeof found->about, "%u bit/s, %s, errors %u sent %u received",
                 (unsigned)link->bitrate, health[link->health], link->transmit_error_count,
                 link->receive_error_count);
    }
    if (!link->up) {
        snprintf(found->first, sizeof found->first, "sudo ip link set %.15s up%s", link->name,
                 link->has_controller && link->bitrate == 0U ? " type can bitrate 1000000" : "");
    }
}

static unsigned probe_can(bool as_json) {
    struct linux_can_link links[DEVICES_MAX];
    struct linux_error error;
    uint32_t count = 0;
    if (linux_can_list(links, DEVICES_MAX, &count, &error) != HAL_OK) {
        message_command("probe", "%s", error.line);
    }
    for (uint32_t i = 0; i < count; i++) {
        struct found found = {.kind = "can"};
        describe_can(&links[i], &found);
        print_found(&found, as_json);
    }
    return count;
}

/// What of `DEVICE: REASON; REMEDY` is to be done.
static void take_remedy(const struct linux_error *error, struct found *found) {
    const char *remedy = strrchr(error->line, ';');
    snprintf(found->first, sizeof found->first, "%.150s",
             remedy != NULL ? remedy + 2 : error->line);
}

static void describe_serial(const char *node, bool shared, bool as_json) {
    struct found found = {.kind = "serial"};
    char path[LINUX_SERIAL_PATH_BYTES];
    struct linux_error error;
    snprintf(path, sizeof path, "%s", node);
    linux_links_prefer(LINUX_LINKS_SERIAL, shared, path, sizeof path);
    snprintf(found.name, sizeof found.name, "%.63s", node);
    snprintf(found.write, sizeof found.write, "bus = slcan:%s", path);
    snprintf(found.about, sizeof found.about, "if it is a slcan adapter");
    if (access(node, R_OK | W_OK) != 0) {
        (void)linux_error_denied(&error, node, node);
        take_remedy(&error, &found);
    }
    print_found(&found, as_json);
}

/// Serial ports may have a slcan adapter, which does not say what it is.
static unsigned probe_serial(bool as_json) {
    glob_t paths = {0};
    unsigned count = 0;
    const int modems = glob("/dev/ttyACM*", 0, NULL, &paths);
    const int adapters = glob("/dev/ttyUSB*", GLOB_APPEND, NULL, &paths);
    if (modems == 0 || adapters == 0) {
        bool shared = false;
        for (size_t i = 0; i < paths.gl_pathc; i++) {
            shared = shared || !linux_links_has_id(LINUX_LINKS_SERIAL, paths.gl_pathv[i]);
        }
        for (size_t i = 0; i < paths.gl_pathc; i++) {
            describe_serial(paths.gl_pathv[i], shared, as_json);
            count++;
        }
    }
    globfree(&paths);
    return count;
}

static unsigned probe_gpio(bool as_json) {
    struct linux_gpio_chip chips[DEVICES_MAX];
    const uint32_t count = linux_gpio_list(chips, DEVICES_MAX);
    for (uint32_t i = 0; i < count && i < DEVICES_MAX; i++) {
        struct found found = {.kind = "gpio"};
        snprintf(found.name, sizeof found.name, "%.63s", chips[i].name);
        snprintf(found.write, sizeof found.write, "estop = %.40s:LINE:up", chips[i].name);
        if (chips[i].error.line[0] != '\0') {
            snprintf(found.about, sizeof found.about, "not looked at");
            take_remedy(&chips[i].error, &found);
        } else {
            snprintf(found.about, sizeof found.about, "'%.63s', lines 0 to %u", chips[i].label,
                     (unsigned)chips[i].line_count - 1U);
        }
        print_found(&found, as_json);
    }
    return count;
}

static unsigned probe_pwm(bool as_json) {
    struct linux_pwm_chip chips[DEVICES_MAX];
    const uint32_t count = linux_pwm_list(LINUX_PWM_ROOT, chips, DEVICES_MAX);
    for (uint32_t i = 0; i < count && i < DEVICES_MAX; i++) {
        struct found found = {.kind = "pwm"};
        snprintf(found.name, sizeof found.name, "%.31s", chips[i].name);
        snprintf(found.write, sizeof found.write, "device = %.31s", chips[i].name);
        snprintf(found.about, sizeof found.about, "%s%schannels 0 to %u", chips[i].driver,
                 chips[i].driver[0] != '\0' ? ", " : "", (unsigned)chips[i].channel_count - 1U);
        char path[100];
        struct linux_error error;
        snprintf(path, sizeof path, "%s/%.31s/export", LINUX_PWM_ROOT, chips[i].name);
        if (access(path, W_OK) != 0) {
            (void)linux_error_denied(&error, chips[i].name, path);
            take_remedy(&error, &found);
        }
        print_found(&found, as_json);
    }
    return count;
}

static const char *maestro_name(uint16_t product) {
    static const char *const names[] = {"Maestro Micro 6", "Maestro Mini 12", "Maestro Mini 18",
                                        "Maestro Mini 24"};
    return product >= 0x0089U && product <= 0x008CU ? names[product - 0x0089U] : NULL;
}

static unsigned probe_maestro(bool as_json) {
    struct hal_usb_identity identities[DEVICES_MAX];
    const unsigned there = linux_usb_list(0x1FFB, identities, DEVICES_MAX);
    unsigned count = 0;
    for (unsigned i = 0; i < there && i < DEVICES_MAX; i++) {
        const char *name = maestro_name(identities[i].product);
        const char *serial = identities[i].serial_number;
        if (name == NULL) {
            continue;
        }
        struct found found = {.kind = "usb"};
        snprintf(found.name, sizeof found.name, "%s", name);
        snprintf(found.write, sizeof found.write, "device = maestro%s%s",
                 serial[0] != '\0' ? ":" : "", serial);
        snprintf(found.about, sizeof found.about, "firmware %u.%02u",
                 identities[i].release_bcd >> 8, identities[i].release_bcd & 255U);
        if (serial[0] == '\0') {
            snprintf(found.first, sizeof found.first, "let this user open it: docs/rig.md, udev");
        }
        print_found(&found, as_json);
        count++;
    }
    return count;
}

/// With the kernel's driver it is a CAN interface, too, and either may be written.
static unsigned probe_gs_usb(bool as_json) {
    struct hal_usb_identity identities[DEVICES_MAX];
    const unsigned there = linux_usb_list(0, identities, DEVICES_MAX);
    unsigned count = 0;
    for (unsigned i = 0; i < there && i < DEVICES_MAX; i++) {
        const char *serial = identities[i].serial_number;
        if (!linux_gs_usb_is_one(&identities[i])) {
            continue;
        }
        struct found found = {.kind = "usb"};
        snprintf(found.name, sizeof found.name, "gs_usb adapter");
        snprintf(found.write, sizeof found.write, "bus = gs_usb%s%s", serial[0] != '\0' ? ":" : "",
                 serial);
        snprintf(found.about, sizeof found.about, "CAN adapter %04x:%04x", identities[i].vendor,
                 identities[i].product);
        if (serial[0] == '\0') {
            snprintf(found.first, sizeof found.first, "let this user open it: docs/rig.md, udev");
        }
        print_found(&found, as_json);
        count++;
    }
    return count;
}

/// "pan, tilt, zoom 100 to 500", or nothing.
static void describe_controls(const struct linux_camera_info *camera, char *text, size_t size) {
    size_t at = 0;
    text[0] = '\0';
    static const char *const names[] = {"pan", "tilt", "zoom"};
    for (unsigned i = 0; i < HAL_CAMERA_CONTROLS && at < size; i++) {
        if ((camera->controls & UINT32_C(1) << i) != 0U) {
            at += (size_t)snprintf(text + at, size - at, "%s%s",
                                   at > 0U ? ", " : "; moves itself: ", names[i]);
        }
    }
    if ((camera->controls & UINT32_C(1) << HAL_CAMERA_ZOOM) != 0U && at < size) {
        snprintf(text + at, size - at, " %d to %d", camera->zoom.min, camera->zoom.max);
    }
}

/// A camera is a source of frames ([camera]), and its own axes are drives.
static void describe_camera(const struct linux_camera_info *camera, struct found *found) {
    static const char *const names[] = {"grey", "yuyv", "mjpeg"};
    char formats[32] = "", controls[80];
    size_t at = 0;
    snprintf(found->name, sizeof found->name, "%.32s", camera->name);
    snprintf(found->write, sizeof found->write, "device = %s", camera->path);
    if (camera->error.line[0] != '\0') {
        snprintf(found->about, sizeof found->about, "not looked at");
        take_remedy(&camera->error, found);
        return;
    }
    for (unsigned i = 0; i < 3U; i++) {
        if ((camera->pixels & UINT32_C(2) << i) != 0U && at < sizeof formats) {
            at += (size_t)snprintf(formats + at, sizeof formats - at, "%s%s", at > 0U ? ", " : "",
                                   names[i]);
        }
    }
    describe_controls(camera, controls, sizeof controls);
    snprintf(found->about, sizeof found->about, "%s up to %ux%u%s%s",
             camera->pixels != 0U ? formats : "no format that this program reads",
             (unsigned)camera->width_px, (unsigned)camera->height_px, controls,
             camera->controls != 0U ? " (drive = uvc)" : "");
}

static unsigned probe_camera(bool as_json) {
    static struct linux_camera_info cameras[DEVICES_MAX];
    const uint32_t count = linux_camera_list(cameras, DEVICES_MAX);
    for (uint32_t i = 0; i < count && i < DEVICES_MAX; i++) {
        struct found found = {.kind = "camera"};
        describe_camera(&cameras[i], &found);
        print_found(&found, as_json);
    }
    return count;
}

static enum exit_status run_command(const struct command *command, int argc, char *const *argv) {
    struct settings settings = {0};
    size_t operands;
    if (!options_read(command->name, command->options, command->option_count, argc, argv, &settings,
                      NULL, 0, &operands)) {
        return EXIT_STATUS_USAGE;
    }
    const unsigned count = probe_can(settings.json) + probe_serial(settings.json) +
                           probe_pwm(settings.json) + probe_maestro(settings.json) +
                           probe_gs_usb(settings.json) + probe_gpio(settings.json) +
                           probe_camera(settings.json);
    if (count == 0U) {
        message_command(command->name, "no CAN interface, serial port, PWM chip, Maestro, GPIO "
                                       "chip or camera is here");
    }
    if (linux_gpio_library() == NULL) {
        message_command(command->name, "GPIO chips are not looked for: built without libgpiod; "
                                       "install libgpiod-dev and build it again");
    }
    if (linux_usb_library() == NULL) {
        message_command(command->name, "USB is not looked at: built without libusb; "
                                       "install libusb-1.0-0-dev and build it again");
    }
    return EXIT_STATUS_OK;
}

const struct command command_probe = {
    .name = "probe",
    .summary = "list the devices that a rig could use",
    .operands = "",
    .help = "Prints a line a device: its kind, its name, what to write into a rig file, what is\n"
            "known of it, and what has to be done before it can be used. With --json, an object a\n"
            "line. CAN interfaces, serial ports (of slcan adapters), PWM chips, Maestro servo\n"
            "controllers, gs_usb CAN adapters, GPIO chips and cameras. Nothing is changed, and\n"
            "nothing moves.\n",
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .run = run_command,
};

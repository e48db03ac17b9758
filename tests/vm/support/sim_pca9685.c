#include "vm/support/sim_pca9685.h"

#include "check.h"
#include "vm/support/shell.h"

#include <fcntl.h>
#include <glob.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define ADDRESS 0x40

enum {
    MODE1 = 0x00,
    MODE2 = 0x01,
    ON_LOW = 0x06, ///< of output 0; then its ON_HIGH, OFF_LOW, OFF_HIGH; then those of output 1
    ALL_OFF_HIGH = 0xFD,
    PRESCALE = 0xFE
};
#define MODE1_SLEEP  0x10U
#define FULL         0x10U ///< of ON_HIGH: always on; of OFF_HIGH, which goes first: always off
#define COUNTS       4096U
#define OSCILLATE_NS 40U

static int bus = -1, bus_number;

static uint8_t access_register(uint8_t number, char direction, uint8_t value) {
    union i2c_smbus_data data = {.byte = value};
    struct i2c_smbus_ioctl_data call = {.read_write = (uint8_t)direction,
                                        .command = number,
                                        .size = I2C_SMBUS_BYTE_DATA,
                                        .data = &data};
    CHECK(ioctl(bus, I2C_SMBUS, &call) == 0);
    return data.byte;
}
static unsigned get(uint8_t number) {
    return access_register(number, I2C_SMBUS_READ, 0);
}
static void put(unsigned number, uint8_t value) {
    (void)access_register((uint8_t)number, I2C_SMBUS_WRITE, value);
}

/// The one path that a pattern stands for; its end, after the last of those characters.
static void find(const char *pattern, char before, char *name, size_t capacity) {
    glob_t found = {0};
    name[0] = '\0';
    if (CHECK(glob(pattern, 0, NULL, &found) == 0) && CHECK_EQ(found.gl_pathc, 1)) {
        snprintf(name, capacity, "%s", strrchr(found.gl_pathv[0], before) + 1);
    }
    globfree(&found);
}

/// The only bus in the machine.
static void open_bus(void) {
    char number[16], path[40];
    find("/sys/bus/i2c/devices/i2c-*", '-', number, sizeof number);
    bus_number = atoi(number);
    snprintf(path, sizeof path, "/dev/i2c-%d", bus_number);
    bus = open(path, O_RDWR | O_CLOEXEC);
    CHECK(bus >= 0);
    CHECK(ioctl(bus, I2C_SLAVE_FORCE, ADDRESS) == 0); // although the driver has it
}

void sim_pca9685_create(char *chip, size_t capacity) {
    char pattern[100];
    if (bus < 0) {
        open_bus();
    }
    put(MODE1, 0x11);
    put(MODE2, 0x04);
    for (unsigned i = 0; i < 16U; i++) {
        for (unsigned k = 0; k < 4U; k++) {
            put(ON_LOW + 4U * i + k, k == 3U ? FULL : 0);
        }
    }
    put(ALL_OFF_HIGH, FULL);
    put(PRESCALE, 30);
    shell("echo pca9685 0x40 >/sys/bus/i2c/devices/i2c-%d/new_device", bus_number);
    snprintf(pattern, sizeof pattern, "/sys/bus/i2c/devices/%d-0040/pwm/pwmchip*", bus_number);
    find(pattern, '/', chip, capacity);
}

void sim_pca9685_remove(void) {
    shell("echo 0x40 >/sys/bus/i2c/devices/i2c-%d/delete_device", bus_number);
}

void sim_pca9685_measure(uint32_t output, uint32_t *pulse_ns, uint32_t *period_ns) {
    const uint8_t at = (uint8_t)(ON_LOW + 4U * output);
    const unsigned on = get(at) | get(at + 1U) << 8, off = get(at + 2U) | get(at + 3U) << 8;
    const unsigned count_ns = OSCILLATE_NS * (get(PRESCALE) + 1U);
    const bool silent = (off & FULL << 8) != 0U || (get(MODE1) & MODE1_SLEEP) != 0U;
    CHECK(silent || (on & FULL << 8) == 0U); // never steadily high
    *pulse_ns = silent ? 0U : (off - on) % COUNTS * count_ns;
    *period_ns = silent ? 0U : COUNTS * count_ns;
}

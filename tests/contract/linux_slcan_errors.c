/// The slcan driver while its calls of the kernel fail, on a pseudo-terminal whose other end takes
/// everything and obeys nothing.
#include "contract/support/contract.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "linux/linux_clock.h"
#include "linux/linux_slcan.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// As somebody else than root, whom a mode of 000 does not keep out.
#define NOBODY 65534

static struct linux_clock clock_;
static struct linux_slcan slcan;
static int master;
static char path[64];

static void new_line(void) {
    master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
        ptsname_r(master, path, sizeof path) != 0) {
        perror("no pseudo-terminal");
        exit(2);
    }
}

static void forbidden(void) {
    const uid_t self = geteuid();
    CHECK_EQ(chmod(path, 0), 0);
    CHECK(self != 0U || seteuid(NOBODY) == 0);
    CHECK_EQ(linux_slcan_open(&slcan, path, 1000000, &clock_.hal), HAL_ERROR_DENIED);
    CHECK_EQ(seteuid(self), 0);
    CHECK(strstr(slcan.error.line, ": no permission; its mode is 000") != NULL);
    CHECK_EQ(hal_can_restart(&slcan.hal), HAL_ERROR_GONE);
    CHECK_EQ(chmod(path, 0600), 0);
}

/// A restart that the port does not take has not been: it is off as before.
static void a_restart_that_fails(void) {
    const struct can_frame frame = {.id = 1};
    struct hal_can_state state;
    CHECK_EQ(linux_slcan_open(&slcan, path, 1000000, &clock_.hal), HAL_OK);
    slcan.state.health = HAL_CAN_OFF;
    syscalls_at(1, SYSCALLS_FAIL, ENOMEM);
    CHECK_EQ(hal_can_restart(&slcan.hal), HAL_ERROR_IO);
    syscalls_at(0, SYSCALLS_FAIL, 0);
    CHECK_EQ(hal_can_state(&slcan.hal, &state), HAL_OK);
    CHECK_EQ(state.health, HAL_CAN_OFF);
    CHECK_EQ(hal_can_send(&slcan.hal, &frame), HAL_ERROR_DOWN);
    CHECK_EQ(hal_can_restart(&slcan.hal), HAL_OK);
    CHECK_EQ(hal_can_send(&slcan.hal, &frame), HAL_OK);
    linux_slcan_close(&slcan);
}

static bool can_be_nobody(void) {
    return geteuid() != 0U || (seteuid(NOBODY) == 0 && seteuid(0) == 0);
}

/// From the far side, when what it says is there.
static void say(const char *text, size_t size) {
    struct pollfd end = {.fd = slcan.serial.fd, .events = POLLIN};
    char old[256];
    syscalls_watch(false);
    while (read(master, old, sizeof old) > 0) {
    }
    CHECK_EQ(write(master, text, size), size);
    CHECK_EQ(poll(&end, 1, 30000), 1);
    syscalls_watch(true);
}

/// From opening to closing, with a restart as after 32 refusals.
static void live(void) {
    const struct linux_error *error = &slcan.error;
    const struct can_frame out = {.id = 0x141, .length = 2, .data = {1, 2}};
    const struct hal_can_filter all = {0};
    struct can_frame got = {.id = 0};
    struct hal_can_state state = {.health = HAL_CAN_OFF};
    uint32_t at_us;
    if (life_note("open", linux_slcan_open(&slcan, path, 1000000, &clock_.hal), error) != HAL_OK) {
        CHECK_EQ(hal_can_send(&slcan.hal, &out), HAL_ERROR_GONE);
        return;
    }
    life_note("filters", hal_can_set_filters(&slcan.hal, &all, 1), error);
    life_note("send", hal_can_send(&slcan.hal, &out), error);
    say("t1411AA\r", 8);
    life_note("receive", hal_can_receive(&slcan.hal, &got, &at_us), error);
    life_value("id", got.id);
    slcan.state.health = HAL_CAN_OFF;
    life_note("restart", hal_can_restart(&slcan.hal), error);
    life_note("state", hal_can_state(&slcan.hal, &state), error);
    life_value("health", state.health);
    linux_slcan_close(&slcan);
}

static void fails_at_every_step(void) {
    const uint32_t io = LIFE_STATUS(HAL_ERROR_IO), gone = LIFE_STATUS(HAL_ERROR_GONE);
    const struct life_error errors[] = {{EIO, io | gone}, {ENODEV, gone}, LIFE_ENOMEM};
    lives_each_failure(&(struct lives){
        .device = path, .live = live, .errors = errors, .error_count = 3, .dies = true});
}

int main(void) {
    linux_clock_open(&clock_, UINT32_MAX - 1000000U);
    slcan.serial.fd = -1;
    new_line();
    CONTRACT_IF(can_be_nobody(), "root can't be anybody else here", "linux_slcan", forbidden);
    CONTRACT("linux_slcan", a_restart_that_fails);
    CONTRACT("linux_slcan", fails_at_every_step);
    close(master);
    return check_finish();
}

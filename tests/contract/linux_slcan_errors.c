/// The slcan driver while its calls of the kernel fail, on a pseudo-terminal whose other end takes
/// everything and obeys nothing.
#include "contract/support/contract.h"
#include "contract/support/lives.h"
#include "contract/support/syscalls.h"
#include "linux/linux_clock.h"
#include "linux/linux_slcan.h"

#include <ctype.h>
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

// ---------------------------------------------------------------- damage on the line

#define LINES 3U

/// Says it; what comes of it up to the frame with the id 0x7FF.
static uint32_t receive_all(const char *text, size_t size, struct can_frame *got,
                            uint32_t capacity) {
    static const char end[] = "z\rt7FF0\r";
    uint32_t count = 0, at_us;
    struct can_frame frame = {.id = 0};
    CHECK_EQ(write(master, text, size), size);
    CHECK_EQ(write(master, end, sizeof end - 1U), sizeof end - 1U);
    for (int tries = 0; frame.id != 0x7FFU && tries < 30000; tries++) {
        if (hal_can_receive(&slcan.hal, &frame, &at_us) != HAL_OK) {
            (void)poll(&(struct pollfd){slcan.serial.fd, POLLIN, 0}, 1, 1);
        } else if (frame.id != 0x7FFU && count < capacity) {
            got[count++] = frame;
        }
    }
    CHECK_EQ(frame.id, 0x7FF); // back in step
    return count;
}

static bool is_among(const struct can_frame *frame, const struct can_frame *list, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (can_frame_equal(frame, &list[i])) {
            return true;
        }
    }
    return false;
}

/// The byte at a place of three lines is another one. The line that is hit is dropped and counted,
/// or is another frame of that form (which adds to *unnoticed); if it was its end the next line may
/// go, too. The others come as they were.
static void damage(const char *text, size_t size, size_t at, char other,
                   const struct can_frame sent[LINES], uint32_t *unnoticed) {
    char damaged[100];
    struct can_frame got[LINES + 1U];
    const uint32_t lost = slcan.state.lost_count, line = (uint32_t)(at / (size / LINES));
    memcpy(damaged, text, size);
    damaged[at] = other;
    const uint32_t count = receive_all(damaged, size, got, LINES + 1U);
    uint32_t whole = 0, strange = 0;
    for (uint32_t i = 0; i < LINES; i++) {
        const bool came = is_among(&sent[i], got, count);
        CHECK(came || i == line || (text[at] == '\r' && i == line + 1U));
        // a digit may be of either case
        CHECK(!came || i != line || (isalpha(text[at]) && (text[at] ^ other) == 0x20));
        whole += came;
    }
    for (uint32_t i = 0; i < count; i++) {
        strange += !is_among(&got[i], sent, LINES);
    }
    CHECK(whole == LINES || strange + slcan.state.lost_count - lost >= 1U);
    *unnoticed += strange;
}

static void a_wrong_byte_costs_its_line(void) {
    static const char text[] =
        "t2418A4184C0006003D00\rt2428921122334455667F\rt241892000000A90300F0\r";
    static const char meaning[] = {'\0', '\r', '\a', 'x'};
    const size_t size = sizeof text - 1U;
    struct can_frame sent[LINES];
    uint32_t unnoticed = 0;
    CHECK_EQ(linux_slcan_open(&slcan, path, 1000000, &clock_.hal), HAL_OK);
    CHECK_EQ(receive_all("half a line\r", 12, sent, LINES), 0);
    CHECK_EQ(slcan.state.lost_count, 0); // of a port that was just opened
    CHECK_EQ(receive_all(text, size, sent, LINES), LINES);
    for (size_t at = 0; at < size && check_clean(); at++) {
        for (unsigned change = 0; change < 12U && check_clean(); change++) {
            const char other = change < 8U ? (char)(text[at] ^ 1 << change) : meaning[change - 8U];
            if (other != text[at]) {
                damage(text, size, at, other, sent, &unnoticed);
            }
        }
    }
    CHECK_EQ(slcan.state.health, HAL_CAN_ACTIVE); // a few bells are no bus-off
    check_note("wrong bytes that make another frame of it", unnoticed);
    check_note("lines that were dropped and counted", slcan.state.lost_count);
    linux_slcan_close(&slcan);
}

int main(void) {
    linux_clock_open(&clock_, UINT32_MAX - 1000000U);
    slcan.serial.fd = -1;
    new_line();
    CONTRACT_IF(can_be_nobody(), "root can't be anybody else here", "linux_slcan", forbidden);
    CONTRACT("linux_slcan", a_restart_that_fails);
    CONTRACT("linux_slcan", a_wrong_byte_costs_its_line);
    CONTRACT("linux_slcan", fails_at_every_step);
    close(master);
    return check_finish();
}

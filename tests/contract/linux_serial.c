/// The serial port of hal/linux on a pseudo-terminal, whose other end the test holds.
#include "linux/linux_serial.h"
#include "contract/support/contract.h"
#include "contract/support/line_speed.h"
#include "contract/support/lives.h"
#include "contract/support/serial_suite.h"
#include "contract/support/syscalls.h"

#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <linux/serial.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

static struct linux_serial serial;
static int master = -1;
static char path[64];

static void new_line(void) {
    syscalls_watch(false);
    if (master >= 0) {
        close(master);
    }
    master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
        ptsname_r(master, path, sizeof path) != 0) {
        perror("no pseudo-terminal");
        exit(2);
    }
    syscalls_watch(true);
}

static void reset(void *context) {
    (void)context;
    syscalls_at(0, SYSCALLS_FAIL, 0);
    linux_serial_close(&serial);
    new_line();
    CHECK_EQ(linux_serial_open(&serial, path, 115200), HAL_OK);
}

static size_t count_of(ssize_t count) {
    CHECK(count >= 0 || errno == EAGAIN || errno == EIO);
    return count > 0 ? (size_t)count : 0U;
}

static size_t peer_write(void *context, const uint8_t *data, size_t size_bytes) {
    (void)context;
    syscalls_watch(false);
    const size_t count = count_of(write(master, data, size_bytes));
    syscalls_watch(true);
    return count;
}

static size_t peer_read(void *context, uint8_t *data, size_t capacity_bytes) {
    (void)context;
    syscalls_watch(false);
    const size_t count = count_of(read(master, data, capacity_bytes));
    syscalls_watch(true);
    return count;
}

/// Until something comes at either end, or a millisecond.
static void settle(void *context) {
    (void)context;
    struct pollfd ends[] = {{.fd = master, .events = POLLIN}, {.fd = serial.fd, .events = POLLIN}};
    syscalls_watch(false);
    poll(ends, 2, 1);
    syscalls_watch(true);
}

static void hang_up(void *context) {
    (void)context;
    close(master);
    master = -1;
}

/// Each call on the port is one system call; a status that stays for good can't be had this way.
static bool fail_at(void *context, uint32_t nth, enum hal_status status) {
    (void)context;
    syscalls_at(nth, SYSCALLS_FAIL, ENOMEM);
    return status == HAL_ERROR_IO;
}

// ---------------------------------------------------------------------------------- how it opens

/// Every speed arrives in the kernel as that number; what it has no name for is refused.
static void speeds(void) {
    const uint32_t good[] = {1200,    2400,    4800,    9600,    19200,   38400,   57600,
                             115200,  230400,  460800,  500000,  576000,  921600,  1000000,
                             1152000, 1500000, 2000000, 2500000, 3000000, 3500000, 4000000};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        linux_serial_close(&serial);
        CHECK_EQ(linux_serial_open(&serial, path, good[i]), HAL_OK);
        CHECK_EQ(line_speed_baud(serial.fd), good[i]);
        CHECK_EQ(line_speed_baud(master), good[i]);
    }
    const uint32_t bad[] = {0, 1, 300, 9601, 115201, 4000001, UINT32_MAX};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        linux_serial_close(&serial);
        CHECK_EQ(linux_serial_open(&serial, path, bad[i]), HAL_ERROR_ARGUMENT);
        char wanted[LINUX_ERROR_BYTES];
        snprintf(wanted, sizeof wanted, "%s: %u baud is no usual speed; use one of 9600 ", path,
                 (unsigned)bad[i]);
        CHECK(strncmp(serial.error.line, wanted, strlen(wanted)) == 0);
        CHECK(strstr(serial.error.line, " 115200 ") != NULL);
        CHECK(strstr(serial.error.line, "... 4000000") != NULL);
    }
}

/// 8N1 without any handshake, and no byte is special, whatever the line was set to before.
static void line_settings(void) {
    linux_serial_close(&serial);
    new_line();
    struct termios settings;
    CHECK_EQ(tcgetattr(master, &settings), 0);
    settings.c_iflag = IXON | IXOFF | ICRNL | INLCR | ISTRIP | BRKINT | PARMRK;
    settings.c_oflag = OPOST | ONLCR;
    settings.c_lflag = ICANON | ECHO | ISIG | IEXTEN;
    settings.c_cflag = CS7 | PARENB | CSTOPB | CRTSCTS | B9600;
    CHECK_EQ(tcsetattr(master, TCSANOW, &settings), 0);
    CHECK_EQ(linux_serial_open(&serial, path, 9600), HAL_OK);
    CHECK_EQ(tcgetattr(serial.fd, &settings), 0);
    CHECK_EQ(settings.c_iflag & (IXON | IXOFF | ICRNL | INLCR | ISTRIP | BRKINT | PARMRK), 0);
    CHECK_EQ(settings.c_iflag & (IGNBRK | IGNPAR | INPCK), IGNBRK | IGNPAR | INPCK);
    CHECK_EQ(settings.c_oflag & OPOST, 0);
    CHECK_EQ(settings.c_lflag & (ICANON | ECHO | ISIG | IEXTEN), 0);
    CHECK_EQ(settings.c_cflag & (PARENB | CSTOPB | CRTSCTS), 0);
    CHECK_EQ(settings.c_cflag & CSIZE, CS8);
    CHECK_EQ(settings.c_cflag & (CLOCAL | CREAD), CLOCAL | CREAD);
    const int flags = fcntl(serial.fd, F_GETFL), fd_flags = fcntl(serial.fd, F_GETFD);
    CHECK((flags & O_NONBLOCK) != 0 && (fd_flags & FD_CLOEXEC) != 0);
    int exclusive = 0;
    CHECK(ioctl(serial.fd, TIOCGEXCL, &exclusive) == 0 && exclusive == 1);
}

/// What came before the port was opened is not for us.
static void old_input_is_dropped(void) {
    linux_serial_close(&serial);
    new_line();
    const int early = open(path, O_RDWR | O_NOCTTY);
    CHECK_EQ(write(master, "old\n", 4), 4);
    settle(NULL);
    usleep(20000);
    CHECK_EQ(linux_serial_open(&serial, path, 115200), HAL_OK);
    uint8_t byte;
    size_t count;
    usleep(20000);
    CHECK_EQ(hal_serial_read(&serial.hal, &byte, 1, &count), HAL_EMPTY);
    close(early);
}

// ------------------------------------------------------------------------------- lines for people

static void expect_refusal(const char *device, enum hal_status wanted, const char *line) {
    struct linux_serial refused;
    CHECK_EQ(linux_serial_open(&refused, device, 115200), wanted);
    if (!CHECK(strcmp(refused.error.line, line) == 0)) {
        printf("  got    %s\n  wanted %s\n", refused.error.line, line);
    }
    CHECK_EQ(refused.fd, -1);
    linux_serial_close(&refused); // closing what never opened does no harm
}

static void missing_and_wrong_devices(void) {
    expect_refusal("/dev/ttyNONE7", HAL_ERROR_GONE,
                   "/dev/ttyNONE7: no such file or device; is it plugged in? `ls /dev/tty[AU]*` "
                   "shows what is there");
    expect_refusal("/dev/null/x", HAL_ERROR_GONE,
                   "/dev/null/x: no such file or device; is it plugged in? `ls /dev/tty[AU]*` "
                   "shows what is there");
    expect_refusal("/dev/null", HAL_ERROR_UNSUPPORTED,
                   "/dev/null: not a serial port; name a device like /dev/ttyACM0");
    char name[LINUX_SERIAL_PATH_BYTES + 1], line[LINUX_ERROR_BYTES];
    memset(name, 'x', sizeof name);
    name[0] = '/';
    name[LINUX_SERIAL_PATH_BYTES] = '\0';
    snprintf(line, sizeof line, "...%s: the name is too long; name a device like /dev/ttyACM0",
             name + sizeof name - 121U);
    expect_refusal(name, HAL_ERROR_ARGUMENT, line);
    name[LINUX_SERIAL_PATH_BYTES - 1] = '\0'; // fits, but isn't there
    snprintf(line, sizeof line, "...%s: %s", name + sizeof name - 122U,
             "no such file or device; is it plugged in? `ls /dev/tty[AU]*` shows what is there");
    struct linux_serial refused;
    const enum hal_status status = linux_serial_open(&refused, name, 115200);
    CHECK(status == HAL_ERROR_GONE || status == HAL_ERROR_IO); // IO: longer than a file name may be
}

static void device_in_use(void) {
    reset(NULL);
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line,
             "%s: in use by another program; end that one first (`fuser -v` on the file shows it)",
             path);
    expect_refusal(path, HAL_ERROR_DENIED, line);
    int exclusive = 0;
    CHECK(ioctl(serial.fd, TIOCGEXCL, &exclusive) == 0 && exclusive == 1); // the refused one let be
    linux_serial_close(&serial);
    const int fd = open(path, O_RDWR | O_NOCTTY); // free again, for those who don't ask as well
    CHECK(fd >= 0 && ioctl(fd, TIOCGEXCL, &exclusive) == 0 && exclusive == 0);
    close(fd);
    CHECK_EQ(linux_serial_open(&serial, path, 115200), HAL_OK);
}

/// Root may do everything, so these two run as somebody else.
#define NOBODY 65534

static void expect_refusal_as_nobody(const char *line) {
    const uid_t self = geteuid();
    CHECK(self != 0U || seteuid(NOBODY) == 0);
    expect_refusal(path, HAL_ERROR_DENIED, line);
    CHECK_EQ(seteuid(self), 0);
}

static void no_permission(void) {
    linux_serial_close(&serial);
    new_line();
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line,
             "%s: no permission; its mode is 000 and no group is let in: a udev rule or chmod has "
             "to change that",
             path);
    CHECK_EQ(chmod(path, 0), 0);
    expect_refusal_as_nobody(line);
}

/// The first group with a name that is neither root's nor ours: on a Debian machine "daemon".
static const struct group *foreign_group(void) {
    const struct group *group = NULL;
    for (gid_t id = 1; id < 100U && group == NULL; id++) {
        group = getgrgid(id);
    }
    return group;
}

static void no_permission_names_the_group(void) {
    linux_serial_close(&serial);
    new_line();
    const struct group *group = foreign_group();
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line,
             "%s: no permission; join group %s (sudo usermod -aG %s $USER) and log in again", path,
             group->gr_name, group->gr_name);
    CHECK(chown(path, (uid_t)-1, group->gr_gid) == 0 && chmod(path, 0060) == 0);
    expect_refusal_as_nobody(line);
}

/// Root of a container may have nobody else to be, and somebody else may not give files away.
static bool can_be_nobody(void) {
    return geteuid() != 0U || (seteuid(NOBODY) == 0 && seteuid(0) == 0);
}

static bool can_give_away(void) {
    const struct group *group = foreign_group();
    return geteuid() == 0U && group != NULL && chown(path, (uid_t)-1, group->gr_gid) == 0;
}

static void line_after_leaving(void) {
    reset(NULL);
    hang_up(NULL);
    uint8_t byte = 0;
    size_t count;
    CHECK_EQ(hal_serial_write(&serial.hal, &byte, 1, &count), HAL_ERROR_GONE);
    char line[LINUX_ERROR_BYTES];
    snprintf(line, sizeof line, "%s: the device has left; plug it in again", path);
    CHECK(strcmp(serial.error.line, line) == 0);
    linux_serial_close(&serial);
    CHECK_EQ(hal_serial_write(&serial.hal, &byte, 1, &count), HAL_ERROR_GONE);
}

// ------------------------------------------------------------------------- failing system calls

/// How a read, a write and a look at the counters answer when the kernel says error_number.
static void expect_answers(int error_number, enum hal_status writing, enum hal_status reading) {
    uint8_t byte = 0x5A;
    size_t count = 77;
    struct hal_serial_state state;
    reset(NULL);
    syscalls_at(1, SYSCALLS_FAIL, error_number);
    CHECK_EQ(hal_serial_write(&serial.hal, &byte, 1, &count), writing);
    CHECK_EQ(count, 0);
    CHECK(writing > HAL_ERROR_ARGUMENT || strncmp(serial.error.line, path, strlen(path)) == 0);
    CHECK_EQ(hal_serial_write(&serial.hal, &byte, 1, &count),
             writing == HAL_ERROR_GONE ? HAL_ERROR_GONE : HAL_OK);
    reset(NULL);
    CHECK_EQ(peer_write(NULL, &byte, 1), 1);
    settle(NULL);
    syscalls_at(1, SYSCALLS_FAIL, error_number);
    CHECK_EQ(hal_serial_read(&serial.hal, &byte, 1, &count), reading);
    CHECK_EQ(count, 0);
    CHECK_EQ(hal_serial_read(&serial.hal, &byte, 1, &count),
             reading == HAL_ERROR_GONE ? HAL_ERROR_GONE : HAL_OK);
    reset(NULL);
    syscalls_at(1, SYSCALLS_FAIL, error_number);
    const enum hal_status counting = hal_serial_state(&serial.hal, &state);
    CHECK_EQ(counting, reading == HAL_EMPTY ? HAL_ERROR_IO : reading);
}

static void failing_reads_and_writes(void) {
    expect_answers(EAGAIN, HAL_BUSY, HAL_EMPTY);
    expect_answers(EINTR, HAL_BUSY, HAL_EMPTY);
    expect_answers(EIO, HAL_ERROR_GONE, HAL_ERROR_GONE);
    expect_answers(ENXIO, HAL_ERROR_GONE, HAL_ERROR_GONE);
    expect_answers(ENODEV, HAL_ERROR_GONE, HAL_ERROR_GONE);
    expect_answers(ENOMEM, HAL_ERROR_IO, HAL_ERROR_IO);
    uint8_t byte;
    size_t count;
    reset(NULL); // a USB adapter that is pulled out reads as the end of a file
    syscalls_at(1, SYSCALLS_ZERO, 0);
    CHECK_EQ(hal_serial_read(&serial.hal, &byte, 1, &count), HAL_ERROR_GONE);
    reset(NULL);
    syscalls_at(1, SYSCALLS_ZERO, 0);
    CHECK_EQ(hal_serial_write(&serial.hal, &byte, 1, &count), HAL_BUSY);
    syscalls_at(0, SYSCALLS_FAIL, 0);
}

/// A port without counters (most USB adapters) counts nothing and is no worse for it.
static void ports_without_counters(void) {
    reset(NULL);
    const int none[] = {ENOTTY, EINVAL};
    for (size_t i = 0; i < 2U; i++) {
        struct hal_serial_state state = {1, 1};
        syscalls_at(1, SYSCALLS_FAIL, none[i]);
        CHECK_EQ(hal_serial_state(&serial.hal, &state), HAL_OK);
        CHECK_EQ(state.lost_count + state.damaged_count, 0);
    }
    syscalls_at(0, SYSCALLS_FAIL, 0);
}

/// What the driver has counted since the port was opened, lost and damaged apart, across a wrap.
static void ports_with_counters(void) {
    struct serial_icounter_struct counters = {.rx = 999,
                                              .tx = 999,
                                              .overrun = 5,
                                              .buf_overrun = -10,
                                              .frame = 7,
                                              .parity = 11,
                                              .brk = 13};
    syscalls_answer_ioctl(TIOCGICOUNT, &counters, sizeof counters);
    reset(NULL);
    struct hal_serial_state state = {1, 1};
    CHECK_EQ(hal_serial_state(&serial.hal, &state), HAL_OK);
    CHECK_EQ(state.lost_count, 0);
    CHECK_EQ(state.damaged_count, 0);
    counters.overrun += 1;
    counters.buf_overrun += 20;
    counters.frame += 300;
    counters.parity += 4000;
    counters.brk += 50000;
    CHECK_EQ(hal_serial_state(&serial.hal, &state), HAL_OK);
    CHECK_EQ(state.lost_count, 21);
    CHECK_EQ(state.damaged_count, 54300);
    syscalls_answer_ioctl(0, NULL, 0);
}

/// Whatever fails while the port is opened: nothing stays open, and a line says what.
static void failing_at_every_step_of_opening(void) {
    const struct {
        int error_number;
        enum hal_status status;
    } errors[] = {{EIO, HAL_ERROR_IO},       {EBUSY, HAL_ERROR_DENIED}, {EACCES, HAL_ERROR_DENIED},
                  {EPERM, HAL_ERROR_DENIED}, {ENODEV, HAL_ERROR_GONE},  {ENXIO, HAL_ERROR_GONE},
                  {ENOENT, HAL_ERROR_GONE},  {ENOTDIR, HAL_ERROR_GONE}};
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++) {
        uint32_t nth = 0;
        enum hal_status status;
        do {
            linux_serial_close(&serial);
            const uint32_t open_files = syscalls_open_files();
            syscalls_at(++nth, SYSCALLS_FAIL, errors[i].error_number);
            status = linux_serial_open(&serial, path, 115200);
            const bool met = syscalls_met();
            syscalls_at(0, SYSCALLS_FAIL, 0);
            CHECK_EQ(status, met ? errors[i].status : HAL_OK);
            if (met) {
                CHECK(strncmp(serial.error.line, path, strlen(path)) == 0);
                CHECK_EQ(serial.fd, -1);
                CHECK_EQ(syscalls_open_files(), open_files);
            }
        } while (status != HAL_OK && nth < 100U);
        CHECK(nth >= 7U && nth < 100U);
    }
}

/// Until something waits to be read there.
static void await(int fd) {
    struct pollfd end = {.fd = fd, .events = POLLIN};
    syscalls_watch(false);
    CHECK_EQ(poll(&end, 1, 30000), 1);
    syscalls_watch(true);
}

/// From opening to closing.
static void live(void) {
    uint8_t out = 0x35, in = 0;
    size_t count = 0;
    struct hal_serial_state state = {9, 9};
    if (life_note("open", linux_serial_open(&serial, path, 115200), &serial.error) != HAL_OK) {
        CHECK_EQ(serial.fd, -1);
        return;
    }
    if (life_note("write", hal_serial_write(&serial.hal, &out, 1, &count), &serial.error) ==
        HAL_OK) {
        await(master);
    }
    life_value("written", (int64_t)count);
    life_value("heard", (int64_t)peer_read(NULL, &in, 1));
    CHECK_EQ(peer_write(NULL, &out, 1), 1);
    await(serial.fd);
    count = 0;
    life_note("read", hal_serial_read(&serial.hal, &in, 1, &count), &serial.error);
    life_value("read", (int64_t)count);
    life_note("state", hal_serial_state(&serial.hal, &state), &serial.error);
    life_value("lost", state.lost_count + state.damaged_count);
    linux_serial_close(&serial);
}

static void fails_at_every_step(void) {
    const uint32_t io = LIFE_STATUS(HAL_ERROR_IO), gone = LIFE_STATUS(HAL_ERROR_GONE);
    const struct life_error errors[] = {{EIO, io | gone},
                                        {ENODEV, gone},
                                        LIFE_ENOMEM,
                                        {EAGAIN, LIFE_STATUS(HAL_BUSY) | LIFE_STATUS(HAL_EMPTY) |
                                                     io | LIFE_STATUS(HAL_ERROR_DENIED)}};
    linux_serial_close(&serial);
    new_line();
    lives_each_failure(&(struct lives){
        .device = path, .live = live, .errors = errors, .error_count = 4, .dies = true});
}

int main(void) {
    serial.fd = -1;
    reset(NULL);
    serial_suite(&(struct serial_fixture){.name = "linux_serial",
                                          .serial = &serial.hal,
                                          .reset = reset,
                                          .peer_write = peer_write,
                                          .peer_read = peer_read,
                                          .settle = settle,
                                          .hang_up = hang_up,
                                          .fail_at = fail_at});
    CONTRACT("linux_serial", speeds);
    CONTRACT("linux_serial", line_settings);
    CONTRACT("linux_serial", old_input_is_dropped);
    CONTRACT("linux_serial", missing_and_wrong_devices);
    CONTRACT("linux_serial", device_in_use);
    CONTRACT_IF(can_be_nobody(), "root can't be anybody else here", "linux_serial", no_permission);
    CONTRACT_IF(can_be_nobody() && can_give_away(), "needs a root that can give files away",
                "linux_serial", no_permission_names_the_group);
    CONTRACT("linux_serial", line_after_leaving);
    CONTRACT("linux_serial", failing_reads_and_writes);
    CONTRACT("linux_serial", ports_without_counters);
    CONTRACT("linux_serial", ports_with_counters);
    CONTRACT("linux_serial", failing_at_every_step_of_opening);
    CONTRACT("linux_serial", fails_at_every_step);
    linux_serial_close(&serial);
    close(master);
    return check_finish();
}

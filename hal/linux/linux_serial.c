#include "linux/linux_serial.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/serial.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#define MISSING_REMEDY "is it plugged in? `ls /dev/tty[AU]*` shows what is there"

static const struct {
    uint32_t baud;
    speed_t speed;
} speeds[] = {{1200, B1200},       {2400, B2400},       {4800, B4800},       {9600, B9600},
              {19200, B19200},     {38400, B38400},     {57600, B57600},     {115200, B115200},
              {230400, B230400},   {460800, B460800},   {500000, B500000},   {576000, B576000},
              {921600, B921600},   {1000000, B1000000}, {1152000, B1152000}, {1500000, B1500000},
              {2000000, B2000000}, {2500000, B2500000}, {3000000, B3000000}, {3500000, B3500000},
              {4000000, B4000000}};

#define SPEED_COUNT (sizeof speeds / sizeof speeds[0])

/// The status of a read or write that failed. A line that was cut answers EIO, ENXIO or ENODEV.
static enum hal_status failed(struct linux_serial *serial, int error_number,
                              enum hal_status not_now) {
    switch (error_number) {
    case EAGAIN:
    case EINTR:
        return not_now;
    case EIO:
    case ENXIO:
    case ENODEV:
        serial->gone = true;
        linux_error_set(&serial->error, serial->path, "the device has left", "plug it in again");
        return HAL_ERROR_GONE;
    default:
        return linux_error_from_errno(&serial->error, serial->path, error_number, MISSING_REMEDY);
    }
}

static enum hal_status linux_serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                          size_t *written_bytes) {
    struct linux_serial *serial = ctx;
    if (serial->gone) {
        return HAL_ERROR_GONE;
    }
    const ssize_t count = write(serial->fd, data, size_bytes);
    if (count < 0) {
        return failed(serial, errno, HAL_BUSY);
    }
    *written_bytes = (size_t)count;
    return count == 0 ? HAL_BUSY : HAL_OK;
}

static enum hal_status linux_serial_read(void *ctx, uint8_t *data, size_t capacity_bytes,
                                         size_t *read_bytes) {
    struct linux_serial *serial = ctx;
    if (serial->gone) {
        return HAL_ERROR_GONE;
    }
    const ssize_t count = read(serial->fd, data, capacity_bytes);
    if (count < 0) {
        return failed(serial, errno, HAL_EMPTY);
    }
    if (count == 0) {
        return failed(serial, ENODEV, HAL_EMPTY); // the end of the file: hung up
    }
    *read_bytes = (size_t)count;
    return HAL_OK;
}

/// The driver's counters since it was loaded; all 0 if it has none.
static int count_errors(int fd, struct hal_serial_state *state) {
    struct serial_icounter_struct counters;
    *state = (struct hal_serial_state){0, 0};
    if (ioctl(fd, TIOCGICOUNT, &counters) != 0) {
        return errno == ENOTTY || errno == EINVAL ? 0 : errno;
    }
    state->lost_count = (uint32_t)counters.overrun + (uint32_t)counters.buf_overrun;
    state->damaged_count =
        (uint32_t)counters.frame + (uint32_t)counters.parity + (uint32_t)counters.brk;
    return 0;
}

static enum hal_status linux_serial_state(void *ctx, struct hal_serial_state *state) {
    struct linux_serial *serial = ctx;
    if (serial->gone) {
        return HAL_ERROR_GONE;
    }
    struct hal_serial_state now;
    const int error_number = count_errors(serial->fd, &now);
    if (error_number != 0) {
        linux_error_set(&serial->error, serial->path, strerror(error_number),
                        "plug it in again; `sudo dmesg | tail` may tell more");
        return failed(serial, error_number, HAL_ERROR_IO);
    }
    state->lost_count = now.lost_count - serial->at_open.lost_count;
    state->damaged_count = now.damaged_count - serial->at_open.damaged_count;
    return HAL_OK;
}

static const struct hal_serial_ops ops = {linux_serial_write, linux_serial_read,
                                          linux_serial_state};

static bool find_speed(uint32_t baud, speed_t *speed) {
    for (size_t i = 0; i < SPEED_COUNT; i++) {
        if (speeds[i].baud == baud) {
            *speed = speeds[i].speed;
            return true;
        }
    }
    return false;
}

static enum hal_status refuse_speed(struct linux_serial *serial, uint32_t baud) {
    char reason[60], remedy[120] = "use one of";
    snprintf(reason, sizeof reason, "%u baud is no usual speed", (unsigned)baud);
    size_t size = strlen(remedy);
    for (size_t i = 3; i < 13U; i++) { // 9600 to 921600, and the end of the list
        size +=
            (size_t)snprintf(remedy + size, sizeof remedy - size, " %u", (unsigned)speeds[i].baud);
    }
    snprintf(remedy + size, sizeof remedy - size, " ... %u",
             (unsigned)speeds[SPEED_COUNT - 1U].baud);
    linux_error_set(&serial->error, serial->path, reason, remedy);
    return HAL_ERROR_ARGUMENT;
}

static enum hal_status open_failed(struct linux_serial *serial, int error_number) {
    if (error_number == ENOTTY) {
        linux_error_set(&serial->error, serial->path, "not a serial port",
                        "name a device like /dev/ttyACM0");
        return HAL_ERROR_UNSUPPORTED;
    }
    if (error_number == EIO) {
        linux_error_set(&serial->error, serial->path, "no port is behind that name",
                        MISSING_REMEDY);
        return HAL_ERROR_IO;
    }
    return linux_error_from_errno(&serial->error, serial->path, error_number, MISSING_REMEDY);
}

/// Raw bytes, 8N1; damaged bytes are dropped. cfmakeraw leaves IXOFF as it was. VMIN 1: a read of
/// nothing is EAGAIN, not an end of file.
static void make_raw(struct termios *settings, speed_t speed) {
    cfmakeraw(settings);
    settings->c_iflag &= ~(tcflag_t)IXOFF;
    settings->c_iflag |= IGNBRK | IGNPAR | INPCK;
    settings->c_cflag &= ~(tcflag_t)(CSTOPB | CRTSCTS);
    settings->c_cflag |= CLOCAL | CREAD;
    settings->c_cc[VMIN] = 1;
    settings->c_cc[VTIME] = 0;
    cfsetispeed(settings, speed);
    cfsetospeed(settings, speed);
}

/// tcsetattr is content if anything at all was set, so look what came of it.
static enum hal_status set_up_line(struct linux_serial *serial, uint32_t baud, speed_t speed) {
    struct termios settings, got;
    if (tcgetattr(serial->fd, &settings) != 0) {
        return open_failed(serial, errno);
    }
    make_raw(&settings, speed);
    if (tcsetattr(serial->fd, TCSANOW, &settings) != 0 || tcgetattr(serial->fd, &got) != 0) {
        return open_failed(serial, errno);
    }
    if (cfgetospeed(&got) != speed || cfgetispeed(&got) != speed) {
        char reason[60];
        snprintf(reason, sizeof reason, "can't do %u baud", (unsigned)baud);
        linux_error_set(&serial->error, serial->path, reason, "choose another speed");
        return HAL_ERROR_UNSUPPORTED;
    }
    if (tcflush(serial->fd, TCIOFLUSH) != 0) {
        return open_failed(serial, errno);
    }
    return HAL_OK;
}

/// Ours alone: flock keeps out whoever asks, TIOCEXCL all others but root.
static enum hal_status claim(struct linux_serial *serial) {
    if (flock(serial->fd, LOCK_EX | LOCK_NB) != 0) {
        return open_failed(serial, errno);
    }
    if (ioctl(serial->fd, TIOCEXCL) != 0) {
        return open_failed(serial, errno);
    }
    serial->exclusive = true;
    return HAL_OK;
}

enum hal_status linux_serial_open(struct linux_serial *serial, const char *path, uint32_t baud) {
    *serial = (struct linux_serial){.fd = -1};
    const size_t size = strlen(path);
    speed_t speed = B0;
    if (size >= sizeof serial->path) {
        linux_error_set(&serial->error, path, "the name is too long",
                        "name a device like /dev/ttyACM0");
        return HAL_ERROR_ARGUMENT;
    }
    memcpy(serial->path, path, size + 1U);
    if (!find_speed(baud, &speed)) {
        return refuse_speed(serial, baud);
    }
    serial->fd = open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (serial->fd < 0) {
        return open_failed(serial, errno);
    }
    enum hal_status status = claim(serial);
    if (status == HAL_OK) {
        status = set_up_line(serial, baud, speed);
    }
    if (status == HAL_OK) {
        const int error_number = count_errors(serial->fd, &serial->at_open);
        status = error_number == 0 ? HAL_OK : open_failed(serial, error_number);
    }
    if (status == HAL_OK) {
        status = hal_serial_bind(&serial->hal, &ops, serial);
    }
    if (status != HAL_OK) {
        linux_serial_close(serial);
    }
    return status;
}

void linux_serial_close(struct linux_serial *serial) {
    if (serial->fd >= 0) {
        if (serial->exclusive) {
            // It would stay as long as anybody has the line open, such as a pty's other end.
            (void)ioctl(serial->fd, TIOCNXCL);
            serial->exclusive = false;
        }
        close(serial->fd);
        serial->fd = -1;
        serial->gone = true;
    }
}

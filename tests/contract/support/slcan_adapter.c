#include "contract/support/slcan_adapter.h"

#include "check.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/// A byte that the driver never sends. The kernel takes its time, but keeps the order: when it has
/// come, all that the driver sent before has.
#define MARK '\001'

/// What the driver could read now; -1: it has no port open.
static int readable(const struct slcan_adapter *adapter) {
    int count;
    return ioctl(adapter->port.serial.fd, FIONREAD, &count) == 0 ? count : -1;
}

void slcan_adapter_say(struct slcan_adapter *adapter, const char *text, size_t size) {
    const int before = readable(adapter);
    CHECK_EQ(write(adapter->master, text, size), size);
    for (int i = 0; i < 300000 && before >= 0 && readable(adapter) < before + (int)size; i++) {
        usleep(100);
    }
    CHECK(before < 0 || readable(adapter) == before + (int)size);
}

static void obey(struct slcan_adapter *adapter, struct slcan_adapter *other) {
    char *line = adapter->line;
    line[adapter->size++] = '\r';
    switch (line[0]) {
    case '\r':
        break;
    case 'C':
        adapter->open = false;
        slcan_adapter_say(adapter, "\r", 1);
        break;
    case 'O':
        adapter->open = true;
        slcan_adapter_say(adapter, "\r", 1);
        break;
    case 'S':
        slcan_adapter_say(adapter, adapter->open ? "\a" : "\r", 1);
        break;
    case 'F':
        slcan_adapter_say(adapter, adapter->flagged ? "F2C\r" : "\a", adapter->flagged ? 4 : 1);
        break;
    default:
        if (!adapter->open || adapter->refusing) {
            slcan_adapter_say(adapter, "\a", 1);
            break;
        }
        slcan_adapter_say(adapter, line[0] == 't' || line[0] == 'r' ? "z\r" : "Z\r", 2);
        if (other->open) {
            slcan_adapter_say(other, line, adapter->size);
        }
    }
    adapter->size = 0;
}

void slcan_adapter_serve(struct slcan_adapter *adapter, struct slcan_adapter *other) {
    char bytes[256];
    const ssize_t count = read(adapter->master, bytes, sizeof bytes);
    CHECK(count > 0 || errno == EAGAIN || errno == EIO);
    for (ssize_t i = 0; i < count; i++) {
        if (bytes[i] == MARK) {
            adapter->marks++;
            continue;
        }
        if (adapter->heard_size < sizeof adapter->heard - 1U) {
            adapter->heard[adapter->heard_size++] = bytes[i];
        }
        if (bytes[i] == '\r') {
            obey(adapter, other);
        } else if (adapter->size < sizeof adapter->line - 1U) {
            adapter->line[adapter->size++] = bytes[i];
        }
    }
}

void slcan_adapter_settle(struct slcan_adapter *adapter, struct slcan_adapter *other) {
    const int port = adapter->port.serial.fd;
    const uint32_t marks = adapter->marks;
    bool marked = readable(adapter) < 0;
    for (int i = 0; i < 30000 && (!marked || (readable(adapter) >= 0 && adapter->marks == marks));
         i++) {
        marked = marked || write(port, &(char){MARK}, 1) == 1; // not while it is full
        struct pollfd ready = {.fd = adapter->master, .events = POLLIN};
        (void)poll(&ready, 1, 1);
        slcan_adapter_serve(adapter, other);
    }
    CHECK(readable(adapter) < 0 || adapter->marks == marks + 1U);
}

void slcan_adapter_plug_in(struct slcan_adapter *adapter, const struct hal_clock *clock) {
    linux_slcan_close(&adapter->port);
    if (adapter->master >= 0) {
        close(adapter->master);
    }
    *adapter = (struct slcan_adapter){.master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)};
    if (adapter->master < 0 || grantpt(adapter->master) != 0 || unlockpt(adapter->master) != 0 ||
        ptsname_r(adapter->master, adapter->path, sizeof adapter->path) != 0) {
        perror("no pseudo-terminal");
        exit(2);
    }
    CHECK_EQ(linux_slcan_open(&adapter->port, adapter->path, 1000000, clock), HAL_OK);
}

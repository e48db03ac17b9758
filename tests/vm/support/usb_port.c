#include "vm/support/usb_port.h"

#include "check.h"

#include <arpa/inet.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define ATTACH      "/sys/devices/platform/vhci_hcd.0/attach"
#define STATUS      "/sys/devices/platform/vhci_hcd.0/status"
#define DATA_MAX    65536U
#define PENDING_MAX 64

// ---------------------------------------------------------------- USB/IP

enum command { SUBMIT = 1, UNLINK = 2, SUBMITTED = 3, UNLINKED = 4 };

/// Big endian, both ways; the meaning of args depends on the command.
struct header {
    uint32_t command, sequence, device, direction_in, endpoint;
    uint32_t args[5];
    uint8_t setup[8];
};
_Static_assert(sizeof(struct header) == 48, "as on the wire");

struct server {
    int fd;
    const struct usb_model *model;
    struct pending {
        uint32_t sequence; ///< as received
        uint8_t endpoint;
        uint32_t size;
    } pending[PENDING_MAX];
    unsigned pending_count;
    uint32_t newest; ///< sequence number of a transfer, in our order of bytes
    struct early {
        uint32_t sequence, wanted; ///< as received; 0: none
    } early;
    uint8_t data[DATA_MAX];
};

static void transfer(int fd, void *bytes, size_t size, bool out) {
    uint8_t *at = bytes;
    while (size > 0U) {
        const ssize_t count = out ? write(fd, at, size) : read(fd, at, size);
        if (count <= 0 && errno != EINTR) {
            _exit(0); // unplugged
        }
        at += count > 0 ? count : 0;
        size -= count > 0 ? (size_t)count : 0U;
    }
}

/// status: 0 or a negative errno. data: only of transfers to the host.
static void answer(struct server *server, uint32_t sequence, int status, uint32_t actual,
                   const uint8_t *data, uint32_t size) {
    struct header header = {.command = htonl(SUBMITTED), .sequence = sequence};
    header.args[0] = htonl((uint32_t)status);
    header.args[1] = htonl(actual);
    transfer(server->fd, &header, sizeof header, true);
    if (size > 0U) {
        transfer(server->fd, (void *)(uintptr_t)data, size, true);
    }
}

// ---------------------------------------------------------------- endpoint 0

static uint16_t u16_at(const uint8_t *bytes) {
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static int string_descriptor(const char *text, uint8_t *data) {
    const size_t size = strlen(text);
    data[0] = (uint8_t)(2U + 2U * size);
    data[1] = 3;
    for (size_t i = 0; i < size; i++) {
        data[2U + 2U * i] = (uint8_t)text[i];
        data[3U + 2U * i] = 0;
    }
    return data[0];
}

static int descriptor(const struct usb_model *model, uint16_t value, uint8_t *data) {
    const unsigned type = value >> 8, index = value & 255U;
    switch (type) {
    case 1:
        memcpy(data, model->device, 18);
        return 18;
    case 2:
        memcpy(data, model->configuration, u16_at(model->configuration + 2));
        return u16_at(model->configuration + 2);
    case 3:
        if (index == 0U) {
            memcpy(data, "\x04\x03\x09\x04", 4); // English
            return 4;
        }
        return index <= 4U && model->strings[index - 1U] != NULL
                   ? string_descriptor(model->strings[index - 1U], data)
                   : USB_MODEL_STALL;
    default:
        return USB_MODEL_STALL;
    }
}

static int control(struct server *server, const uint8_t setup[8], uint16_t size) {
    const struct usb_model *model = server->model;
    if ((setup[0] & 0x60U) == 0U) { // a standard request
        switch (setup[1]) {
        case 0:
            memset(server->data, 0, 2);
            return 2;
        case 6:
            return descriptor(model, u16_at(setup + 2), server->data);
        default:
            return 0; // set configuration, set interface, clear halt
        }
    }
    return model->control == NULL ? USB_MODEL_STALL
                                  : model->control(model->ctx, setup, server->data, size);
}

// ---------------------------------------------------------------- serving

/// Answers what an IN endpoint can answer now, each endpoint in order.
static void serve_pending(struct server *server) {
    for (unsigned i = 0; i < server->pending_count;) {
        const struct pending now = server->pending[i];
        bool first = true;
        for (unsigned k = 0; k < i; k++) {
            first = first && server->pending[k].endpoint != now.endpoint;
        }
        const int count =
            first ? server->model->bulk_in(server->model->ctx, now.endpoint, server->data, now.size)
                  : USB_MODEL_LATER;
        if (count == USB_MODEL_LATER) {
            i++;
            continue;
        }
        server->pending_count--;
        memmove(&server->pending[i], &server->pending[i + 1U],
                (server->pending_count - i) * sizeof now);
        answer(server, now.sequence, count < 0 ? -EPIPE : 0, count < 0 ? 0U : (uint32_t)count,
               server->data, count < 0 ? 0U : (uint32_t)count);
    }
}

static void answer_unlink(struct server *server, uint32_t sequence, int status) {
    struct header reply = {.command = htonl(UNLINKED), .sequence = sequence};
    reply.args[0] = htonl((uint32_t)status);
    transfer(server->fd, &reply, sizeof reply, true);
}

/// The kernel can send this before the transfer that it is about: of what lies between its two
/// lists, a transfer and its end. Answered at once, it would take back that transfer, and take the
/// answer to it for a broken connection.
static void unlink_pending(struct server *server, const struct header *header) {
    int status = 0;
    if ((int32_t)(ntohl(header->args[0]) - server->newest) > 0) {
        server->early = (struct early){header->sequence, header->args[0]};
        return;
    }
    for (unsigned i = 0; i < server->pending_count; i++) {
        if (server->pending[i].sequence == header->args[0]) {
            server->pending_count--;
            memmove(&server->pending[i], &server->pending[i + 1U],
                    (server->pending_count - i) * sizeof *server->pending);
            status = -ECONNRESET;
            break;
        }
    }
    answer_unlink(server, header->sequence, status);
}

static void submit(struct server *server, const struct header *header) {
    const uint8_t endpoint = (uint8_t)ntohl(header->endpoint);
    const bool in = ntohl(header->direction_in) != 0U;
    const uint32_t size = ntohl(header->args[1]) < DATA_MAX ? ntohl(header->args[1]) : DATA_MAX;
    if (!in && size > 0U) {
        transfer(server->fd, server->data, size, false);
    }
    server->newest = ntohl(header->sequence);
    if (server->early.wanted == header->sequence) {
        server->early.wanted = 0;
        answer_unlink(server, server->early.sequence, -ECONNRESET);
        return;
    }
    if (endpoint == 0U) {
        int count = control(server, header->setup, u16_at(header->setup + 6));
        const uint32_t most = u16_at(header->setup + 6);
        const uint32_t sent = count < 0 ? 0U : (uint32_t)count < most ? (uint32_t)count : most;
        answer(server, header->sequence, count < 0 ? -EPIPE : 0, in ? sent : size, server->data,
               in ? sent : 0U);
    } else if (in) {
        server->pending[server->pending_count++ % PENDING_MAX] =
            (struct pending){header->sequence, endpoint, size};
    } else {
        const int count = server->model->bulk_out(server->model->ctx, endpoint, server->data, size);
        answer(server, header->sequence, count < 0 ? -EPIPE : 0, count < 0 ? 0U : (uint32_t)count,
               NULL, 0);
    }
}

static void serve(int fd, int kick_fd, const struct usb_model *model) {
    static struct server server;
    server.fd = fd;
    server.model = model;
    for (;;) {
        struct header header;
        struct pollfd ready[] = {{fd, POLLIN, 0}, {kick_fd, POLLIN, 0}};
        while (poll(ready, 2, 2) <= 0 || ready[0].revents == 0) {
            uint64_t kicks;
            (void)!read(kick_fd, &kicks, sizeof kicks);
            serve_pending(&server); // the model may have been given something by the test
        }
        transfer(fd, &header, sizeof header, false);
        if (ntohl(header.command) == UNLINK) {
            unlink_pending(&server, &header);
        } else {
            submit(&server, &header);
        }
        serve_pending(&server);
    }
}

// ---------------------------------------------------------------- plugging

/// What the test has open is none of the device's: whatever it has locked would stay so.
static void close_others(int kept, int also_kept) {
    for (int fd = 3; fd < 1024; fd++) {
        if (fd != kept && fd != also_kept) {
            close(fd);
        }
    }
}

void usb_port_plug(struct usb_port *port, unsigned number, const struct usb_model *model) {
    int ends[2];
    char text[64];
    *port = (struct usb_port){.number = number};
    if (!CHECK_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0)) {
        return;
    }
    FILE *attach = fopen(ATTACH, "w");
    snprintf(text, sizeof text, "%u %d %u %u", number, ends[0], 0x10001U + number,
             (unsigned)model->speed);
    CHECK(attach != NULL && fputs(text, attach) >= 0 && fclose(attach) == 0);
    port->kick_fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    CHECK(port->kick_fd >= 0);
    fflush(stdout);
    port->child = fork();
    if (port->child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close_others(ends[1], port->kick_fd);
        serve(ends[1], port->kick_fd, model);
    }
    close(ends[0]);
    close(ends[1]);
}

/// A line of the status file: hub, port, sta (4: free, 6: used), speed, device, socket, bus id.
static bool is_free(unsigned number) {
    char line[128];
    bool free_now = false;
    FILE *file = fopen(STATUS, "r");
    while (file != NULL && fgets(line, sizeof line, file) != NULL) {
        unsigned port, state;
        free_now = free_now ||
                   (sscanf(line, "%*s %u %u", &port, &state) == 2 && port == number && state == 4U);
    }
    if (file != NULL) {
        fclose(file);
    }
    return free_now;
}

void usb_port_unplug(struct usb_port *port) {
    if (port->child > 0) {
        kill(port->child, SIGKILL);
        waitpid(port->child, NULL, 0);
        port->child = 0;
        close(port->kick_fd);
        int tries = 500;
        while (tries > 0 && !is_free(port->number)) {
            usleep(10000);
            tries--;
        }
        CHECK(tries > 0);
    }
}

void usb_port_kick(const struct usb_port *port) {
    const uint64_t once = 1;
    if (port->child > 0) {
        (void)!write(port->kick_fd, &once, sizeof once);
    }
}

void *usb_port_share(size_t size_bytes) {
    void *memory =
        mmap(NULL, size_bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) {
        perror("no shared memory");
        exit(2);
    }
    return memory;
}

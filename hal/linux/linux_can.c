#include "linux/linux_can.h"

#include "linux/linux_can_errors.h"
#include "linux/linux_can_link.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>
// The kernel's struct of that name would clash with ours.
#define can_frame kernel_can_frame
#include <linux/can.h>
#include <linux/can/raw.h>
#undef can_frame

/// Error frames that one call digests at most, so that a storm of them can't hold it up.
#define ERROR_FRAMES_MAX 32
#define LINK_REMEDY      "`ip -details link show` tells more"
/// What is asked of the kernel to restart is not asked again sooner.
#define RESTART_PAUSE_US 100000U

// ---------------------------------------------------------------- health

static void set_health(struct linux_can *can, enum hal_can_health health) {
    linux_can_set_health(&can->state, health);
}

static void set_link_down(struct linux_can *can) {
    can->link_down = true;
    set_health(can, HAL_CAN_OFF);
    char remedy[80];
    snprintf(remedy, sizeof remedy, "sudo ip link set %s up", can->name);
    linux_error_set(&can->error, can->name, "the interface was taken down", remedy);
}

static enum hal_status set_gone(struct linux_can *can) {
    can->gone = true;
    linux_error_set(&can->error, can->name, "the interface has gone",
                    "plug the adapter in again, then set its bit rate and take it up (ip link)");
    return HAL_ERROR_GONE;
}

static void digest_error(struct linux_can *can, const struct kernel_can_frame *frame) {
    if (linux_can_digest_error(&can->state, frame->can_id, frame->data)) {
        linux_error_set(&can->error, can->name, "bus-off",
                        "check cable, termination and bit rate; it is restarted");
    }
}

// ---------------------------------------------------------------- operations

/// The status of a read or write that failed.
static enum hal_status failed(struct linux_can *can, int error_number, enum hal_status not_now) {
    switch (error_number) {
    case EAGAIN:
    case EINTR:
    case ENOBUFS:
        return not_now;
    case ENETDOWN:
        set_link_down(can);
        return not_now == HAL_BUSY ? HAL_ERROR_DOWN : HAL_EMPTY;
    case ENODEV:
    case ENXIO:
        return set_gone(can);
    default:
        break;
    }
    const enum hal_status status =
        linux_error_from_errno(&can->error, can->name, error_number, LINK_REMEDY);
    return status == HAL_ERROR_DENIED ? HAL_ERROR_IO : status; // it is ours
}

/// Error frames have a socket of their own, so that the state is known also when nobody receives.
/// Returns: HAL_OK; HAL_ERROR_IO, HAL_ERROR_GONE.
static enum hal_status digest_errors(struct linux_can *can) {
    struct kernel_can_frame frame;
    ssize_t size = 0;
    for (int i = 0; i < ERROR_FRAMES_MAX && size >= 0; i++) {
        size = recv(can->error_fd, &frame, sizeof frame, MSG_DONTWAIT);
        if (size == (ssize_t)sizeof frame && (frame.can_id & CAN_ERR_FLAG) != 0U) {
            digest_error(can, &frame);
        }
    }
    const enum hal_status status = size < 0 ? failed(can, errno, HAL_EMPTY) : HAL_OK;
    return status == HAL_EMPTY ? HAL_OK : status;
}

static enum hal_status linux_can_send(void *ctx, const struct can_frame *frame) {
    struct linux_can *can = ctx;
    const enum hal_status status = can->gone ? HAL_ERROR_GONE : digest_errors(can);
    if (status != HAL_OK) {
        return status;
    }
    if (can->state.health == HAL_CAN_OFF) {
        return HAL_ERROR_DOWN;
    }
    struct kernel_can_frame out = {.can_id = frame->id, .len = frame->length};
    out.can_id |= (frame->flags & CAN_FRAME_EXTENDED) != 0U ? CAN_EFF_FLAG : 0U;
    if ((frame->flags & CAN_FRAME_REMOTE) != 0U) {
        out.can_id |= CAN_RTR_FLAG;
    } else {
        memcpy(out.data, frame->data, frame->length);
    }
    if (write(can->fd, &out, sizeof out) != (ssize_t)sizeof out) {
        return failed(can, errno, HAL_BUSY);
    }
    return HAL_OK;
}

/// The time of arrival on the driver's clock. The kernel's stamp is of the clock that people set.
static uint32_t arrival_us(const struct linux_can *can, const struct timespec *stamp) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    const uint32_t now_us = hal_clock_now_us(can->clock);
    const int64_t age_ns =
        (int64_t)(now.tv_sec - stamp->tv_sec) * 1000000000 + now.tv_nsec - stamp->tv_nsec;
    // Somebody has set the clock in between: the time of reading is the best we have.
    const bool believable = age_ns >= 0 && age_ns < INT64_C(10000000000);
    return believable ? now_us - (uint32_t)(age_ns / 1000) : now_us;
}

/// One frame of the kernel's; *stamp is 0 without a time.
static ssize_t read_frame(struct linux_can *can, struct kernel_can_frame *frame,
                          struct timespec *stamp) {
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t))];
    } control;
    struct iovec data = {frame, sizeof *frame};
    struct msghdr message = {.msg_iov = &data,
                             .msg_iovlen = 1,
                             .msg_control = &control,
                             .msg_controllen = sizeof control};
    *stamp = (struct timespec){0, 0};
    const ssize_t size = recvmsg(can->fd, &message, MSG_DONTWAIT);
    if (size < 0) {
        return size;
    }
    for (struct cmsghdr *at = CMSG_FIRSTHDR(&message); at != NULL; at = CMSG_NXTHDR(&message, at)) {
        if (at->cmsg_level == SOL_SOCKET && at->cmsg_type == SO_TIMESTAMPNS) {
            memcpy(stamp, CMSG_DATA(at), sizeof *stamp);
        } else if (at->cmsg_level == SOL_SOCKET && at->cmsg_type == SO_RXQ_OVFL) {
            memcpy(&can->socket_drops, CMSG_DATA(at), sizeof can->socket_drops);
        }
    }
    return size;
}

static bool translate(const struct kernel_can_frame *from, struct can_frame *to) {
    const bool extended = (from->can_id & CAN_EFF_FLAG) != 0U;
    *to = (struct can_frame){.id = from->can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK),
                             .length = from->len};
    to->flags |= extended ? CAN_FRAME_EXTENDED : 0;
    to->flags |= (from->can_id & CAN_RTR_FLAG) != 0U ? CAN_FRAME_REMOTE : 0;
    memcpy(to->data, from->data, sizeof to->data);
    return can_frame_is_valid(to);
}

static enum hal_status linux_can_receive(void *ctx, struct can_frame *frame,
                                         uint32_t *received_us) {
    struct linux_can *can = ctx;
    if (can->gone) {
        return HAL_ERROR_GONE;
    }
    struct kernel_can_frame got;
    struct can_frame translated;
    struct timespec stamp;
    const ssize_t size = read_frame(can, &got, &stamp);
    if (size < 0) {
        const enum hal_status status = failed(can, errno, HAL_EMPTY);
        return status == HAL_EMPTY && !can->link_down && digest_errors(can) == HAL_ERROR_GONE
                   ? HAL_ERROR_GONE
                   : status;
    }
    if (size != (ssize_t)sizeof got || !translate(&got, &translated)) {
        return HAL_EMPTY; // no classic frame; there may be more
    }
    if (can->link_down) { // what comes in shows that it is up again
        can->link_down = false;
        set_health(can, HAL_CAN_ACTIVE);
    }
    *frame = translated;
    *received_us = stamp.tv_sec != 0 ? arrival_us(can, &stamp) : hal_clock_now_us(can->clock);
    return HAL_OK;
}

static enum hal_status linux_can_state(void *ctx, struct hal_can_state *state) {
    struct linux_can *can = ctx;
    const enum hal_status status = can->gone ? HAL_ERROR_GONE : digest_errors(can);
    if (status != HAL_OK) {
        return status;
    }
    *state = can->state;
    state->lost_count += can->socket_drops;
    return HAL_OK;
}

/// A filter as the kernel has them. False: no frame passes it (and the kernel could not say so).
static bool translate_filter(const struct hal_can_filter *from, struct can_filter *to) {
    const unsigned kinds = CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE;
    const bool standard_only =
        (from->flags_mask & CAN_FRAME_EXTENDED) != 0U && (from->flags & CAN_FRAME_EXTENDED) == 0U;
    const uint32_t id_max = standard_only ? CAN_SFF_MASK : CAN_EFF_MASK;
    if ((from->id & from->id_mask) > id_max || (from->flags & from->flags_mask & ~kinds) != 0U) {
        return false;
    }
    const uint32_t id_mask = from->id_mask & CAN_EFF_MASK;
    *to = (struct can_filter){.can_id = from->id & id_mask, .can_mask = id_mask};
    if ((from->flags_mask & CAN_FRAME_EXTENDED) != 0U) {
        to->can_mask |= CAN_EFF_FLAG;
        to->can_id |= (from->flags & CAN_FRAME_EXTENDED) != 0U ? CAN_EFF_FLAG : 0U;
    }
    if ((from->flags_mask & CAN_FRAME_REMOTE) != 0U) {
        to->can_mask |= CAN_RTR_FLAG;
        to->can_id |= (from->flags & CAN_FRAME_REMOTE) != 0U ? CAN_RTR_FLAG : 0U;
    }
    return true;
}

static enum hal_status linux_can_set_filters(void *ctx, const struct hal_can_filter *filters,
                                             uint32_t count) {
    struct linux_can *can = ctx;
    if (can->gone) {
        return HAL_ERROR_GONE;
    }
    struct can_filter list[HAL_CAN_FILTERS_MAX];
    socklen_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        used += translate_filter(&filters[i], &list[used]) ? 1U : 0U;
    }
    if (setsockopt(can->fd, SOL_CAN_RAW, CAN_RAW_FILTER, used == 0U ? NULL : list,
                   used * (socklen_t)sizeof *list) != 0) {
        return failed(can, errno, HAL_ERROR_IO);
    }
    return HAL_OK;
}

/// Up again. What the sockets still have to tell of the time before is forgotten.
static enum hal_status begin_anew(struct linux_can *can) {
    const int fds[] = {can->fd, can->error_fd};
    for (unsigned i = 0; i < 2U; i++) {
        int error;
        socklen_t size = sizeof error;
        if (getsockopt(fds[i], SOL_SOCKET, SO_ERROR, &error, &size) != 0) {
            return failed(can, errno, HAL_ERROR_IO);
        }
    }
    can->link_down = false;
    set_health(can, HAL_CAN_ACTIVE);
    return HAL_OK;
}

static enum hal_status restart_link(struct linux_can *can) {
    const enum hal_status status = linux_can_link_is_up(can->fd, can->name, &can->error);
    if (status == HAL_OK) {
        return begin_anew(can);
    }
    can->gone = status == HAL_ERROR_GONE;
    return status == HAL_ERROR_DOWN ? HAL_ERROR_DENIED : status;
}

static enum hal_status linux_can_restart(void *ctx) {
    struct linux_can *can = ctx;
    if (can->gone) {
        return HAL_ERROR_GONE;
    }
    if (can->state.health != HAL_CAN_OFF) {
        return HAL_OK;
    }
    if (can->link_down) {
        return restart_link(can);
    }
    const uint32_t now_us = hal_clock_now_us(can->clock);
    if (can->restarting && now_us - can->restart_us < RESTART_PAUSE_US) {
        return can->restart_status;
    }
    can->restarting = true;
    can->restart_us = now_us;
    bool bounced;
    can->restart_status =
        linux_can_link_restart(can->fd, can->index, can->name, &bounced, &can->error);
    if (can->restart_status == HAL_OK && bounced) {
        can->restart_status = begin_anew(can); // taken down and up: no error frame tells of it
    }
    can->gone = can->restart_status == HAL_ERROR_GONE;
    return can->restart_status;
}

static const struct hal_can_ops ops = {linux_can_send, linux_can_receive, linux_can_state,
                                       linux_can_set_filters, linux_can_restart};

// ---------------------------------------------------------------- opening

static enum hal_status open_failed(struct linux_can *can) {
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
        linux_error_set(&can->error, can->name, "this kernel has no CAN",
                        "sudo modprobe can_raw, or use a kernel that has it");
        return HAL_ERROR_UNSUPPORTED;
    }
    return linux_error_from_errno(&can->error, can->name, errno, LINK_REMEDY);
}

static enum hal_status set_up_socket(struct linux_can *can) {
    const can_err_mask_t errors = LINUX_CAN_ERROR_CONTROLLER | LINUX_CAN_ERROR_OFF |
                                  LINUX_CAN_ERROR_RESTARTED | LINUX_CAN_ERROR_COUNTERS;
    const int on = 1;
    const struct sockaddr_can address = {.can_family = AF_CAN, .can_ifindex = can->index};
    can->fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    can->error_fd = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (can->fd < 0 || can->error_fd < 0 ||
        setsockopt(can->error_fd, SOL_CAN_RAW, CAN_RAW_FILTER, NULL, 0) != 0 ||
        setsockopt(can->error_fd, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0 ||
        bind(can->error_fd, (const struct sockaddr *)&address, sizeof address) != 0 ||
        setsockopt(can->fd, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) != 0 ||
        setsockopt(can->fd, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on) != 0 ||
        bind(can->fd, (const struct sockaddr *)&address, sizeof address) != 0) {
        return open_failed(can);
    }
    can->gone = false;
    return HAL_OK;
}

enum hal_status linux_can_open(struct linux_can *can, const char *name,
                               const struct hal_clock *clock) {
    // Bound from the beginning: whoever holds it may go on calling when it can't be opened again.
    *can = (struct linux_can){.fd = -1, .error_fd = -1, .gone = true, .clock = clock};
    if (hal_can_bind(&can->hal, &ops, can) != HAL_OK) {
        return HAL_ERROR_ARGUMENT;
    }
    if (strlen(name) >= sizeof can->name || name[0] == '\0') {
        linux_error_set(&can->error, name, "not the name of a network interface",
                        "name one like can0");
        return HAL_ERROR_ARGUMENT;
    }
    memcpy(can->name, name, strlen(name) + 1U);
    struct linux_can_link link;
    enum hal_status status = linux_can_link_find(can->name, &link, &can->error);
    if (status == HAL_OK && !link.up) {
        linux_can_link_explain_down(&link, &can->error);
        status = HAL_ERROR_DOWN;
    }
    if (status == HAL_OK) {
        can->index = link.index;
        set_health(can, link.health);
        status = set_up_socket(can);
    }
    if (status != HAL_OK) {
        linux_can_close(can);
    }
    return status;
}

void linux_can_close(struct linux_can *can) {
    if (can->fd >= 0) {
        close(can->fd);
    }
    if (can->error_fd >= 0) {
        close(can->error_fd);
    }
    can->fd = can->error_fd = -1;
    can->gone = true;
}

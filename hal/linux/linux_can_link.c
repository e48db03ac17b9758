#include "linux/linux_can_link.h"

#include <errno.h>
#include <linux/can/netlink.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

/// A message of the kernel about a link is far shorter.
#define MESSAGE_BYTES 32768
#define LINK_REMEDY   "`ip -details link show` tells more"
#define UP_TRIES      2
#define DENIED_REMEDY "run as root, or set restart-ms (sudo ip link set %s type can restart-ms 100)"

// ---------------------------------------------------------------- reading

/// Attributes: u16 size with this head, u16 type, content, padding to 4.
struct span {
    const uint8_t *at, *end;
};

static bool next_attribute(struct span *rest, unsigned *type, struct span *content) {
    struct rtattr head;
    if ((size_t)(rest->end - rest->at) < sizeof head) {
        return false;
    }
    memcpy(&head, rest->at, sizeof head);
    const size_t left = (size_t)(rest->end - rest->at), padded = (head.rta_len + 3U) & ~3U;
    if (head.rta_len < sizeof head || head.rta_len > left) {
        return false;
    }
    *type = head.rta_type & (unsigned)NLA_TYPE_MASK;
    *content = (struct span){rest->at + sizeof head, rest->at + head.rta_len};
    rest->at += padded < left ? padded : left;
    return true;
}

static void copy(void *to, size_t size, const struct span *from) {
    const size_t there = (size_t)(from->end - from->at);
    memset(to, 0, size);
    memcpy(to, from->at, there < size ? there : size);
}

static void read_controller(struct span data, struct linux_can_link *link) {
    unsigned type;
    struct span content;
    link->has_controller = true;
    while (next_attribute(&data, &type, &content)) {
        if (type == IFLA_CAN_BITTIMING) {
            struct can_bittiming timing;
            copy(&timing, sizeof timing, &content);
            link->bitrate = timing.bitrate;
        } else if (type == IFLA_CAN_STATE) {
            uint32_t state;
            copy(&state, sizeof state, &content);
            link->health = state == CAN_STATE_BUS_OFF         ? HAL_CAN_OFF
                           : state == CAN_STATE_ERROR_PASSIVE ? HAL_CAN_PASSIVE
                                                              : HAL_CAN_ACTIVE;
        } else if (type == IFLA_CAN_RESTART_MS) {
            copy(&link->restart_ms, sizeof link->restart_ms, &content);
        } else if (type == IFLA_CAN_BERR_COUNTER) {
            struct can_berr_counter counters;
            copy(&counters, sizeof counters, &content);
            link->transmit_error_count = counters.txerr;
            link->receive_error_count = counters.rxerr;
        }
    }
}

static void read_link_info(struct span info, struct linux_can_link *link) {
    unsigned type;
    struct span content, data = {NULL, NULL};
    char kind[8] = "";
    while (next_attribute(&info, &type, &content)) {
        if (type == IFLA_INFO_KIND) {
            copy(kind, sizeof kind - 1U, &content);
        } else if (type == IFLA_INFO_DATA) {
            data = content;
        }
    }
    if (strcmp(kind, "can") == 0 && data.at != NULL) {
        read_controller(data, link);
    }
}

/// A RTM_NEWLINK message. Returns whether it is a CAN interface; the name is set in any case.
static bool read_link(const struct nlmsghdr *head, const uint8_t *message,
                      struct linux_can_link *link) {
    struct ifinfomsg about;
    *link = (struct linux_can_link){0};
    if (head->nlmsg_len < NLMSG_HDRLEN + sizeof about) {
        return false;
    }
    memcpy(&about, message + NLMSG_HDRLEN, sizeof about);
    link->index = about.ifi_index;
    link->up = (about.ifi_flags & IFF_UP) != 0U;
    struct span rest = {message + NLMSG_HDRLEN + NLMSG_ALIGN(sizeof about),
                        message + head->nlmsg_len};
    unsigned type;
    struct span content;
    while (next_attribute(&rest, &type, &content)) {
        if (type == IFLA_IFNAME) {
            copy(link->name, sizeof link->name - 1U, &content);
        } else if (type == IFLA_LINKINFO) {
            read_link_info(content, link);
        }
    }
    return about.ifi_type == ARPHRD_CAN;
}

// ---------------------------------------------------------------- talking to the kernel

/// A routing socket. The kernel answers before send returns; the time-out is for its bugs.
static int open_routing(void) {
    const struct timeval patience = {.tv_sec = 1};
    const int fd = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
    if (fd >= 0) {
        (void)setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    }
    return fd;
}

/// Whether a message of the type NLMSG_ERROR tells of one, which is then in errno.
static bool is_refused(const struct nlmsghdr *head, const uint8_t *message) {
    int32_t code = 0;
    if (head->nlmsg_len >= NLMSG_HDRLEN + sizeof code) {
        memcpy(&code, message + NLMSG_HDRLEN, sizeof code);
    }
    errno = -code;
    return code != 0;
}

/// Calls visit for each link until it says false. False: errno tells what went wrong.
static bool each_link(bool (*visit)(void *context, bool is_can, const struct linux_can_link *link),
                      void *context) {
    struct {
        struct nlmsghdr head;
        struct ifinfomsg about;
    } request = {.head = {.nlmsg_len = sizeof request,
                          .nlmsg_type = RTM_GETLINK,
                          .nlmsg_flags = NLM_F_REQUEST | NLM_F_DUMP,
                          .nlmsg_seq = 1},
                 .about = {.ifi_family = AF_UNSPEC}};
    uint8_t buffer[MESSAGE_BYTES];
    const int fd = open_routing();
    bool good = fd >= 0 && send(fd, &request, sizeof request, 0) == (ssize_t)sizeof request;
    bool more = good;
    while (more) {
        const ssize_t size = recv(fd, buffer, sizeof buffer, 0);
        more = good = size > 0;
        for (size_t at = 0; more && at + NLMSG_HDRLEN <= (size_t)size;) {
            struct nlmsghdr head;
            memcpy(&head, buffer + at, sizeof head);
            if (head.nlmsg_len < NLMSG_HDRLEN || head.nlmsg_len > (size_t)size - at ||
                head.nlmsg_type == NLMSG_DONE || head.nlmsg_type == NLMSG_ERROR) {
                good = head.nlmsg_type != NLMSG_ERROR || !is_refused(&head, buffer + at);
                more = false;
                break;
            }
            struct linux_can_link link;
            const bool is_can = read_link(&head, buffer + at, &link);
            more = visit(context, is_can, &link);
            at += NLMSG_ALIGN(head.nlmsg_len);
        }
    }
    if (fd >= 0) {
        close(fd);
    }
    return good;
}

struct search {
    const char *name;
    struct linux_can_link *found;
    bool there, is_can;
};

static bool is_it(void *context, bool is_can, const struct linux_can_link *link) {
    struct search *search = context;
    if (strcmp(link->name, search->name) != 0) {
        return true;
    }
    *search->found = *link;
    search->there = true;
    search->is_can = is_can;
    return false;
}

enum hal_status linux_can_link_find(const char *name, struct linux_can_link *link,
                                    struct linux_error *error) {
    struct search search = {.name = name, .found = link};
    if (!each_link(is_it, &search)) {
        return linux_error_from_errno(error, name, errno, LINK_REMEDY);
    }
    if (!search.there) {
        linux_error_set(error, name, "no such interface",
                        "is the adapter plugged in? `boresight probe` lists what is there");
        return HAL_ERROR_GONE;
    }
    if (!search.is_can) {
        linux_error_set(error, name, "not a CAN interface", "`boresight probe` lists them");
        return HAL_ERROR_UNSUPPORTED;
    }
    return HAL_OK;
}

struct listing {
    struct linux_can_link *links;
    uint32_t capacity, count;
};

static bool enter(void *context, bool is_can, const struct linux_can_link *link) {
    struct listing *listing = context;
    if (is_can && listing->count < listing->capacity) {
        listing->links[listing->count++] = *link;
    }
    return true;
}

enum hal_status linux_can_list(struct linux_can_link *links, uint32_t capacity, uint32_t *count,
                               struct linux_error *error) {
    struct listing listing = {.links = links, .capacity = capacity};
    const bool good = each_link(enter, &listing);
    *count = listing.count;
    return good ? HAL_OK : linux_error_from_errno(error, "network interfaces", errno, LINK_REMEDY);
}

void linux_can_link_explain_down(const struct linux_can_link *link, struct linux_error *error) {
    char remedy[120];
    if (link->has_controller && link->bitrate == 0U) {
        snprintf(remedy, sizeof remedy, "sudo ip link set %s up type can bitrate 1000000",
                 link->name);
    } else {
        snprintf(remedy, sizeof remedy, "sudo ip link set %s up", link->name);
    }
    linux_error_set(error, link->name, "the interface is down", remedy);
}

// ---------------------------------------------------------------- changing

static enum hal_status get_flags(int socket, const char *name, struct ifreq *request,
                                 struct linux_error *error) {
    *request = (struct ifreq){0};
    memcpy(request->ifr_name, name, strlen(name));
    if (ioctl(socket, SIOCGIFFLAGS, request) == 0) {
        return HAL_OK;
    }
    if (errno == ENODEV || errno == ENXIO) {
        linux_error_set(error, name, "the interface has gone", "plug the adapter in again");
        return HAL_ERROR_GONE;
    }
    return linux_error_from_errno(error, name, errno, LINK_REMEDY);
}

enum hal_status linux_can_link_is_up(int socket, const char *name, struct linux_error *error) {
    struct ifreq request;
    const enum hal_status status = get_flags(socket, name, &request, error);
    if (status == HAL_OK && (request.ifr_flags & IFF_UP) == 0) {
        const struct linux_can_link link = {.up = false};
        struct linux_can_link named = link;
        memcpy(named.name, request.ifr_name, sizeof named.name);
        linux_can_link_explain_down(&named, error);
        return HAL_ERROR_DOWN;
    }
    return status;
}

static enum hal_status explain_denied(const char *name, struct linux_error *error) {
    char remedy[120];
    snprintf(remedy, sizeof remedy, DENIED_REMEDY, name);
    linux_error_set(error, name, "bus-off, and this user may not restart it", remedy);
    return HAL_ERROR_DENIED;
}

/// The driver can't restart its controller, but opening it does.
static enum hal_status bounce(int socket, const char *name, struct linux_error *error) {
    struct ifreq request;
    const enum hal_status status = get_flags(socket, name, &request, error);
    if (status != HAL_OK) {
        return status;
    }
    const short up = request.ifr_flags;
    request.ifr_flags = (short)(up & ~IFF_UP);
    bool good = ioctl(socket, SIOCSIFFLAGS, &request) == 0;
    request.ifr_flags = up;
    for (int tries = 0; good && tries < UP_TRIES; tries++) {
        if (ioctl(socket, SIOCSIFFLAGS, &request) == 0) {
            return HAL_OK;
        }
        good = errno != ENODEV && errno != EPERM; // whoever took it down takes it up
    }
    return errno == EPERM ? explain_denied(name, error)
                          : linux_error_from_errno(error, name, errno, LINK_REMEDY);
}

enum hal_status linux_can_link_restart(int socket, int index, const char *name, bool *bounced,
                                       struct linux_error *error) {
    struct {
        struct nlmsghdr head;
        struct ifinfomsg about;
        struct rtattr info;
        struct rtattr kind;
        char can[4];
        struct rtattr data;
        struct rtattr restart;
        uint32_t one;
    } request = {.head = {.nlmsg_len = sizeof request,
                          .nlmsg_type = RTM_NEWLINK,
                          .nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK,
                          .nlmsg_seq = 1},
                 .about = {.ifi_family = AF_UNSPEC, .ifi_index = index},
                 .info = {4 + 8 + 12, IFLA_LINKINFO},
                 .kind = {4 + 3, IFLA_INFO_KIND},
                 .can = "can",
                 .data = {4 + 8, IFLA_INFO_DATA},
                 .restart = {4 + 4, IFLA_CAN_RESTART},
                 .one = 1};
    struct {
        struct nlmsghdr head;
        struct nlmsgerr error;
        char rest[512];
    } answer;
    *bounced = false;
    const int fd = open_routing();
    const bool answered = fd >= 0 &&
                          send(fd, &request, sizeof request, 0) == (ssize_t)sizeof request &&
                          recv(fd, &answer, sizeof answer, 0) >=
                              (ssize_t)(sizeof answer.head + sizeof answer.error.error) &&
                          answer.head.nlmsg_type == NLMSG_ERROR;
    const int error_number = answered ? -answer.error.error : errno;
    if (fd >= 0) {
        close(fd);
    }
    switch (error_number) {
    case 0:
    case EBUSY:  // no longer bus-off
    case EINVAL: // restart-ms is set: the kernel does it by itself
        return HAL_OK;
    case EPERM:
        return explain_denied(name, error);
    case EOPNOTSUPP:
        *bounced = true;
        return bounce(socket, name, error);
    case ENODEV:
        linux_error_set(error, name, "the interface has gone", "plug the adapter in again");
        return HAL_ERROR_GONE;
    default:
        return linux_error_from_errno(error, name, error_number, LINK_REMEDY);
    }
}

#include "linux/linux_usb_private.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/time.h>

#if HAVE_LIBUSB

#include <libusb-1.0/libusb.h>

/// How often close looks whether what it cancelled has ended; each time it waits 10 ms at most.
#define CLOSE_TRIES  100
#define OTHER_REMEDY "unplug it and plug it in again; `sudo dmesg | tail` may tell more"

struct linux_usb_slot {
    struct libusb_transfer *transfer; ///< null: free
    struct hal_usb_transfer *owner;
    struct linux_usb *usb;
    bool ended;
    uint32_t number; ///< counts submissions
    uint8_t data[LIBUSB_CONTROL_SETUP_SIZE + HAL_USB_TRANSFER_BYTES_MAX];
};

// ---------------------------------------------------------------- errors

static enum hal_status set_gone(struct linux_usb *usb) {
    usb->gone = true;
    linux_error_set(&usb->error, usb->name, "the device has left", "plug it in again");
    return HAL_ERROR_GONE;
}

static enum hal_status failed(struct linux_usb *usb, int code) {
    switch (code) {
    case LIBUSB_ERROR_NO_DEVICE:
        return set_gone(usb);
    case LIBUSB_ERROR_BUSY:
        return HAL_BUSY;
    case LIBUSB_ERROR_INVALID_PARAM:
    case LIBUSB_ERROR_NOT_FOUND:
        return HAL_ERROR_ARGUMENT;
    default:
        linux_error_set(&usb->error, usb->name, libusb_strerror((enum libusb_error)code),
                        OTHER_REMEDY);
        return HAL_ERROR_IO;
    }
}

static enum hal_status status_of(enum libusb_transfer_status status) {
    switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
        return HAL_OK;
    case LIBUSB_TRANSFER_STALL:
        return HAL_ERROR_UNSUPPORTED;
    case LIBUSB_TRANSFER_TIMED_OUT:
        return HAL_ERROR_TIMEOUT;
    case LIBUSB_TRANSFER_CANCELLED:
        return HAL_ERROR_CANCELLED;
    case LIBUSB_TRANSFER_NO_DEVICE:
        return HAL_ERROR_GONE;
    default:
        return HAL_ERROR_IO;
    }
}

// ---------------------------------------------------------------- operations

static enum hal_status linux_usb_identity(void *ctx, struct hal_usb_identity *identity) {
    const struct linux_usb *usb = ctx;
    if (usb->gone) {
        return HAL_ERROR_GONE;
    }
    *identity = usb->identity;
    return HAL_OK;
}

/// Called by libusb from within poll.
static void LIBUSB_CALL transfer_ended(struct libusb_transfer *transfer) {
    struct linux_usb_slot *slot = transfer->user_data;
    struct linux_usb *usb = slot->usb;
    slot->ended = true;
    usb->done[usb->done_count++] = (int8_t)(slot - usb->slots);
}

static int find_slot(const struct linux_usb *usb, const struct hal_usb_transfer *owner) {
    for (int i = 0; i < HAL_USB_PENDING_MAX; i++) {
        if (usb->slots[i].owner == owner) {
            return i;
        }
    }
    return -1;
}

static void fill(struct linux_usb *usb, struct linux_usb_slot *slot,
                 struct hal_usb_transfer *transfer) {
    const unsigned timeout_ms = (transfer->timeout_us + 999U) / 1000U;
    struct libusb_device_handle *device = usb->device;
    if (transfer->kind == HAL_USB_CONTROL) {
        const struct hal_usb_setup *setup = &transfer->setup;
        libusb_fill_control_setup(slot->data, setup->request_type, setup->request, setup->value,
                                  setup->index, transfer->size_bytes);
        if ((setup->request_type & HAL_USB_IN) == 0U && transfer->size_bytes > 0U) {
            memcpy(slot->data + LIBUSB_CONTROL_SETUP_SIZE, transfer->data, transfer->size_bytes);
        }
        libusb_fill_control_transfer(slot->transfer, device, slot->data, transfer_ended, slot,
                                     timeout_ms);
    } else {
        if ((transfer->endpoint & HAL_USB_IN) == 0U && transfer->size_bytes > 0U) {
            memcpy(slot->data, transfer->data, transfer->size_bytes);
        }
        libusb_fill_bulk_transfer(slot->transfer, device, transfer->endpoint, slot->data,
                                  transfer->size_bytes, transfer_ended, slot, timeout_ms);
    }
}

static enum hal_status linux_usb_submit(void *ctx, struct hal_usb_transfer *transfer) {
    struct linux_usb *usb = ctx;
    if (usb->gone) {
        return HAL_ERROR_GONE;
    }
    const int index = find_slot(usb, NULL);
    if (index < 0) {
        return HAL_BUSY;
    }
    struct linux_usb_slot *slot = &usb->slots[index];
    slot->ended = false;
    fill(usb, slot, transfer);
    const int code = libusb_submit_transfer(slot->transfer);
    if (code != 0) {
        return failed(usb, code);
    }
    slot->owner = transfer;
    slot->number = usb->submitted++;
    transfer->status = HAL_BUSY;
    transfer->actual_bytes = 0;
    usb->pending_count++;
    return HAL_OK;
}

/// Hands the slot's transfer back to its owner.
static struct hal_usb_transfer *give_back(struct linux_usb *usb, struct linux_usb_slot *slot) {
    struct hal_usb_transfer *owner = slot->owner;
    const struct libusb_transfer *from = slot->transfer;
    const bool control = owner->kind == HAL_USB_CONTROL;
    const bool in = ((control ? owner->setup.request_type : owner->endpoint) & HAL_USB_IN) != 0U;
    owner->actual_bytes = (uint16_t)from->actual_length;
    if (in && from->actual_length > 0) {
        memcpy(owner->data, slot->data + (control ? LIBUSB_CONTROL_SETUP_SIZE : 0),
               (size_t)from->actual_length);
    }
    owner->status = status_of(from->status);
    if (owner->status == HAL_ERROR_GONE) {
        (void)set_gone(usb);
    }
    slot->owner = NULL;
    usb->pending_count--;
    return owner;
}

static uint8_t endpoint_of(const struct linux_usb_slot *slot) {
    return slot->owner->kind == HAL_USB_CONTROL ? 0U : slot->owner->endpoint;
}

/// The place in usb->done of what is handed back next, or -1. The kernel ends the transfers of a
/// device that leaves in any order; those of an endpoint are handed back in that of their
/// submission.
static int find_done(const struct linux_usb *usb) {
    const struct linux_usb_slot *first = &usb->slots[usb->done[0]];
    if (first->transfer->status != LIBUSB_TRANSFER_NO_DEVICE) {
        return 0;
    }
    const uint8_t endpoint = endpoint_of(first);
    for (int i = 0; i < HAL_USB_PENDING_MAX; i++) {
        const struct linux_usb_slot *slot = &usb->slots[i];
        if (slot->owner != NULL && endpoint_of(slot) == endpoint && slot->number < first->number) {
            first = slot;
        }
    }
    for (unsigned i = 0; i < usb->done_count; i++) {
        if (&usb->slots[usb->done[i]] == first) {
            return (int)i;
        }
    }
    return -1; // it has not ended yet
}

static void notice_departure(struct linux_usb *usb) {
    struct pollfd about = {usb->fd, 0, 0};
    if (!usb->gone && usb->fd >= 0 && poll(&about, 1, 0) > 0 &&
        (about.revents & (POLLHUP | POLLERR)) != 0) {
        (void)set_gone(usb);
    }
}

/// Lets libusb look, without waiting.
static int look(struct linux_usb *usb) {
    struct timeval now = {0, 0}; // the same in 32 and in 64 bits, whichever libusb was built with
    const int code = libusb_handle_events_timeout_completed(usb->context, &now, NULL);
    return code == LIBUSB_ERROR_INTERRUPTED ? 0 : code;
}

static enum hal_status look_failed(struct linux_usb *usb, int code) {
    if (code == LIBUSB_ERROR_NO_DEVICE) {
        return set_gone(usb);
    }
    linux_error_set(&usb->error, usb->name, libusb_strerror((enum libusb_error)code), OTHER_REMEDY);
    return HAL_ERROR_IO;
}

static enum hal_status linux_usb_poll(void *ctx, struct hal_usb_transfer **done) {
    struct linux_usb *usb = ctx;
    int at = usb->done_count > 0U ? find_done(usb) : -1;
    if (at < 0 && usb->pending_count > 0U) {
        const int code = look(usb);
        at = usb->done_count > 0U ? find_done(usb) : -1;
        if (code != 0 && at < 0) {
            return look_failed(usb, code);
        }
    }
    if (at < 0) {
        if (usb->pending_count == 0U) {
            notice_departure(usb);
        }
        return usb->gone && usb->pending_count == 0U ? HAL_ERROR_GONE : HAL_EMPTY;
    }
    struct linux_usb_slot *slot = &usb->slots[usb->done[at]];
    usb->done_count--;
    memmove(usb->done + at, usb->done + at + 1, usb->done_count - (unsigned)at);
    *done = give_back(usb, slot);
    return HAL_OK;
}

static enum hal_status linux_usb_cancel(void *ctx, struct hal_usb_transfer *transfer) {
    struct linux_usb *usb = ctx;
    const int index = find_slot(usb, transfer);
    if (index < 0) {
        return usb->gone ? HAL_ERROR_GONE : HAL_ERROR_ARGUMENT;
    }
    if (!usb->slots[index].ended) {
        // Not found: it has just ended, and poll will hand it back.
        const int code = libusb_cancel_transfer(usb->slots[index].transfer);
        return code == 0 || code == LIBUSB_ERROR_NOT_FOUND ? HAL_OK : failed(usb, code);
    }
    return HAL_OK;
}

static const struct hal_usb_ops ops = {linux_usb_identity, linux_usb_submit, linux_usb_poll,
                                       linux_usb_cancel};

// ---------------------------------------------------------------- opening

/// The file that libusb has opened for the device: the one it polls now and did not before.
static bool find_file(struct linux_usb *usb) {
    const struct libusb_pollfd **list = libusb_get_pollfds(usb->context);
    for (unsigned i = 0; list != NULL && list[i] != NULL; i++) {
        usb->fd = (list[i]->events & POLLOUT) != 0 ? list[i]->fd : usb->fd;
    }
    libusb_free_pollfds(list);
    return list != NULL;
}

static enum hal_status open_failed(struct linux_usb *usb, int code) {
    switch (code) {
    case LIBUSB_ERROR_NOT_FOUND:
    case LIBUSB_ERROR_NO_DEVICE:
        linux_error_set(&usb->error, usb->name, "no such USB device",
                        "is it plugged in? `boresight probe` lists what is there");
        return HAL_ERROR_GONE;
    case LIBUSB_ERROR_ACCESS:
        linux_error_set(&usb->error, usb->name, "no permission",
                        "install the udev rules of docs/rig.md, or run as root, and plug it in "
                        "again");
        return HAL_ERROR_DENIED;
    case LIBUSB_ERROR_BUSY:
        linux_error_set(&usb->error, usb->name, "in use by another program", "end that one first");
        return HAL_ERROR_DENIED;
    default:
        linux_error_set(&usb->error, usb->name, libusb_strerror((enum libusb_error)code),
                        OTHER_REMEDY);
        return HAL_ERROR_IO;
    }
}

static bool allocate(struct linux_usb *usb) {
    usb->slots = calloc(HAL_USB_PENDING_MAX, sizeof *usb->slots);
    bool good = usb->slots != NULL;
    for (unsigned i = 0; good && i < HAL_USB_PENDING_MAX; i++) {
        usb->slots[i].usb = usb;
        usb->slots[i].transfer = libusb_alloc_transfer(0);
        good = usb->slots[i].transfer != NULL;
    }
    return good;
}

enum hal_status linux_usb_open(struct linux_usb *usb, const struct linux_usb_wanted *wanted) {
    memset(usb, 0, sizeof *usb);
    usb->gone = true;
    usb->claimed = usb->fd = -1;
    linux_usb_name(usb, wanted, NULL);
    libusb_context *context = NULL;
    int code =
        hal_usb_bind(&usb->hal, &ops, usb) == HAL_OK ? libusb_init(&context) : LIBUSB_ERROR_OTHER;
    usb->context = context;
    if (code == 0) {
        code = linux_usb_find(usb, wanted);
    }
    if (code == 0 && wanted->interface >= 0) {
        (void)libusb_set_auto_detach_kernel_driver(usb->device, 1);
        code = libusb_claim_interface(usb->device, wanted->interface);
        usb->claimed = code == 0 ? wanted->interface : -1;
    }
    if (code == 0 && usb->claimed >= 0) {
        code = linux_usb_find_endpoints(usb);
    }
    if (code == 0 && (!find_file(usb) || !allocate(usb))) {
        code = LIBUSB_ERROR_NO_MEM;
    }
    // Requests to the whole device need no claim, so another program could send them as well:
    // among those that ask, one is enough.
    if (code == 0 && usb->fd >= 0 && flock(usb->fd, LOCK_EX | LOCK_NB) != 0) {
        code = errno == EWOULDBLOCK ? LIBUSB_ERROR_BUSY : LIBUSB_ERROR_IO;
    }
    if (code != 0) {
        const enum hal_status status = open_failed(usb, code);
        linux_usb_close(usb);
        return status;
    }
    usb->gone = false;
    return HAL_OK;
}

/// Ends whatever is under way.
static void cancel_all(struct linux_usb *usb) {
    for (int i = 0; i < CLOSE_TRIES && usb->pending_count > 0U; i++) {
        for (unsigned k = 0; k < HAL_USB_PENDING_MAX; k++) {
            if (usb->slots[k].owner != NULL && !usb->slots[k].ended) {
                (void)libusb_cancel_transfer(usb->slots[k].transfer);
            }
        }
        struct pollfd ended = {usb->fd, POLLOUT, 0};
        (void)look(usb);
        if (usb->done_count == 0U) {
            (void)poll(&ended, 1, 10);
        }
        struct hal_usb_transfer *done;
        while (usb->done_count > 0U && linux_usb_poll(usb, &done) == HAL_OK) {
        }
    }
}

void linux_usb_close(struct linux_usb *usb) {
    if (usb->slots != NULL) {
        cancel_all(usb);
    }
    if (usb->device != NULL) {
        if (usb->claimed >= 0) {
            (void)libusb_release_interface(usb->device, usb->claimed);
        }
        libusb_close(usb->device);
        usb->device = NULL;
    }
    if (usb->slots != NULL) { // last: what could not be ended has ended with the device
        for (unsigned i = 0; i < HAL_USB_PENDING_MAX; i++) {
            if (usb->slots[i].owner != NULL) {
                usb->slots[i].owner->status = HAL_ERROR_CANCELLED;
            }
            libusb_free_transfer(usb->slots[i].transfer);
        }
        free(usb->slots);
        usb->slots = NULL;
    }
    if (usb->context != NULL) {
        libusb_exit(usb->context);
        usb->context = NULL;
    }
    usb->gone = true;
    usb->fd = -1;
}

#else

enum hal_status linux_usb_open(struct linux_usb *usb, const struct linux_usb_wanted *wanted) {
    memset(usb, 0, sizeof *usb);
    linux_error_set(&usb->error, wanted->what, "this program was built without libusb",
                    "install libusb-1.0-0-dev and build it again");
    return HAL_ERROR_UNSUPPORTED;
}

void linux_usb_close(struct linux_usb *usb) {
    usb->gone = true;
}

#endif

#include "contract/support/libusb_model.h"

#include "check.h"
#include "contract/support/syscalls.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if HAVE_LIBUSB

#include <libusb-1.0/libusb.h>
#include <poll.h>

#define PENDING_MAX 64U

/// What the library keeps to itself.
struct libusb_context {
    struct libusb_device_handle *open;
};
struct libusb_device {
    unsigned number;
};
struct libusb_device_handle {
    struct libusb_device *device;
    struct libusb_context *context;
    int claimed;
    int ends[2]; ///< a pipe: its end 1 stands for the file of the device
};

struct libusb_model_faults libusb_model_faults;

static const struct libusb_model *plugged[LIBUSB_MODEL_DEVICES];
static struct libusb_device devices[LIBUSB_MODEL_DEVICES] = {{0}, {1}};
static struct libusb_device_handle *handles[LIBUSB_MODEL_DEVICES]; ///< the one that is open
static struct pending {
    struct libusb_transfer *transfer;
    bool cancelled;
    unsigned looks; ///< at it: each is a millisecond
} pending[PENDING_MAX];
static unsigned pending_count, object_count;

unsigned libusb_model_objects(void) {
    return object_count + pending_count;
}

void libusb_model_plug(unsigned number, const struct libusb_model *model) {
    if (model == NULL && plugged[number] != NULL && handles[number] != NULL) {
        syscalls_watch(false);
        close(handles[number]->ends[0]); // its file says so
        syscalls_watch(true);
        handles[number]->ends[0] = -1;
    }
    plugged[number] = model;
}

static int fails(const char *name) {
    int code = 0;
    return syscalls_fails(name, &code) ? code : 0;
}

static void *make(size_t size) {
    void *const object = calloc(1, size);
    if (object == NULL) {
        abort();
    }
    object_count++;
    return object;
}

static void take_back(void *object) {
    CHECK(object_count > 0U);
    object_count--;
    free(object);
}

// ---------------------------------------------------------------- finding and opening

int libusb_init(libusb_context **context) {
    const int code = fails("libusb_init");
    *context = code == 0 ? make(sizeof **context) : NULL;
    return code;
}

void libusb_exit(libusb_context *context) {
    CHECK(context->open == NULL);
    take_back(context);
}

ssize_t libusb_get_device_list(libusb_context *context, libusb_device ***list) {
    (void)context;
    const int code = fails("libusb_get_device_list");
    if (code != 0) {
        return code;
    }
    *list = make((LIBUSB_MODEL_DEVICES + 1U) * sizeof **list);
    ssize_t count = 0;
    for (unsigned i = 0; i < LIBUSB_MODEL_DEVICES; i++) {
        if (plugged[i] != NULL) {
            (*list)[count++] = &devices[i];
        }
    }
    return count;
}

void libusb_free_device_list(libusb_device **list, int unref) {
    CHECK(unref != 0);
    take_back((void *)list);
}

int libusb_get_device_descriptor(libusb_device *device,
                                 struct libusb_device_descriptor *descriptor) {
    const struct libusb_model *model = plugged[device->number];
    const int code = model == NULL ? LIBUSB_ERROR_NO_DEVICE : fails("libusb_get_device_descriptor");
    if (code != 0) {
        return code;
    }
    *descriptor =
        (struct libusb_device_descriptor){.idVendor = model->vendor,
                                          .idProduct = model->product,
                                          .bcdDevice = model->release_bcd,
                                          .iSerialNumber = model->serial_number != NULL ? 3 : 0};
    return 0;
}

int libusb_open(libusb_device *device, libusb_device_handle **handle) {
    int code = libusb_model_faults.open[device->number];
    code = code == 0 ? fails("libusb_open") : code;
    if (code != 0 || plugged[device->number] == NULL) {
        return code != 0 ? code : LIBUSB_ERROR_NO_DEVICE;
    }
    *handle = make(sizeof **handle);
    (*handle)->device = device;
    (*handle)->claimed = -1;
    CHECK_EQ(pipe((*handle)->ends), 0);
    handles[device->number] = *handle;
    return 0;
}

void libusb_close(libusb_device_handle *handle) {
    CHECK_EQ(handle->claimed, -1);
    for (unsigned i = 0; i < pending_count;) { // what is under way ends with its device
        if (pending[i].transfer->dev_handle == handle) {
            pending[i].transfer->dev_handle = NULL;
            pending[i] = pending[--pending_count];
        } else {
            i++;
        }
    }
    syscalls_watch(false);
    for (unsigned i = 0; i < 2U; i++) {
        if (handle->ends[i] >= 0) {
            close(handle->ends[i]);
        }
    }
    syscalls_watch(true);
    if (handles[handle->device->number] == handle) {
        handles[handle->device->number] = NULL;
    }
    take_back(handle);
}

libusb_device *libusb_get_device(libusb_device_handle *handle) {
    return handle->device;
}

int libusb_get_string_descriptor_ascii(libusb_device_handle *handle, uint8_t index,
                                       unsigned char *text, int capacity) {
    const struct libusb_model *model = plugged[handle->device->number];
    const int code = model == NULL                        ? LIBUSB_ERROR_NO_DEVICE
                     : libusb_model_faults.serial_refused ? LIBUSB_ERROR_PIPE
                                                          : fails("libusb_get_string");
    if (code != 0) {
        return code;
    }
    CHECK_EQ(index, 3);
    CHECK(strlen(model->serial_number) < (size_t)capacity);
    strcpy((char *)text, model->serial_number);
    return (int)strlen(model->serial_number);
}

int libusb_set_auto_detach_kernel_driver(libusb_device_handle *handle, int enable) {
    (void)handle;
    (void)enable;
    return fails("libusb_set_auto_detach_kernel_driver");
}

int libusb_claim_interface(libusb_device_handle *handle, int interface) {
    const int code = fails("libusb_claim_interface");
    if (code != 0 || libusb_model_faults.busy) {
        return code != 0 ? code : LIBUSB_ERROR_BUSY;
    }
    handle->claimed = interface;
    return 0;
}

/// It is given back even if that fails: nothing of it is left in the library.
int libusb_release_interface(libusb_device_handle *handle, int interface) {
    CHECK_EQ(handle->claimed, interface);
    handle->claimed = -1;
    return fails("libusb_release_interface");
}

static const struct libusb_endpoint_descriptor endpoints[] = {
    {.bEndpointAddress = 0x81, .bmAttributes = LIBUSB_TRANSFER_TYPE_BULK},
    {.bEndpointAddress = 0x02, .bmAttributes = LIBUSB_TRANSFER_TYPE_BULK}};
static const struct libusb_interface_descriptor setting = {.bNumEndpoints = 2,
                                                           .endpoint = endpoints};
static const struct libusb_interface interface = {.altsetting = &setting, .num_altsetting = 1};

int libusb_get_active_config_descriptor(libusb_device *device,
                                        struct libusb_config_descriptor **config) {
    (void)device;
    const int code = fails("libusb_get_active_config_descriptor");
    if (code == 0) {
        *config = make(sizeof **config);
        **config = (struct libusb_config_descriptor){.bNumInterfaces = 1, .interface = &interface};
    }
    return code;
}

void libusb_free_config_descriptor(struct libusb_config_descriptor *config) {
    take_back(config);
}

/// Two files of the library's own are not listed: the drivers look for that of the device.
const struct libusb_pollfd **libusb_get_pollfds(libusb_context *context) {
    (void)context;
    static struct libusb_pollfd files[LIBUSB_MODEL_DEVICES];
    if (fails("libusb_get_pollfds") != 0) {
        return NULL;
    }
    const struct libusb_pollfd **list = make((LIBUSB_MODEL_DEVICES + 1U) * sizeof *list);
    unsigned count = 0;
    for (unsigned i = 0; i < LIBUSB_MODEL_DEVICES; i++) {
        if (handles[i] != NULL) {
            files[i] = (struct libusb_pollfd){handles[i]->ends[1], POLLOUT};
            list[count++] = &files[i];
        }
    }
    return list;
}

void libusb_free_pollfds(const struct libusb_pollfd **list) {
    if (list != NULL) {
        take_back((void *)list);
    }
}

// ---------------------------------------------------------------- transfers

struct libusb_transfer *libusb_alloc_transfer(int packets) {
    CHECK_EQ(packets, 0);
    return fails("libusb_alloc_transfer") != 0 ? NULL : make(sizeof(struct libusb_transfer));
}

static unsigned place_of(const struct libusb_transfer *transfer) {
    unsigned at = 0;
    while (at < pending_count && pending[at].transfer != transfer) {
        at++;
    }
    return at;
}

void libusb_free_transfer(struct libusb_transfer *transfer) {
    if (transfer != NULL) {
        CHECK_EQ(place_of(transfer), pending_count); // not while it is under way
        take_back(transfer);
    }
}

int libusb_submit_transfer(struct libusb_transfer *transfer) {
    const int code = fails("libusb_submit_transfer");
    if (code != 0) {
        return code;
    }
    if (plugged[transfer->dev_handle->device->number] == NULL) {
        return LIBUSB_ERROR_NO_DEVICE;
    }
    if (CHECK(pending_count < PENDING_MAX && place_of(transfer) == pending_count)) {
        pending[pending_count++] = (struct pending){transfer, false, 0};
    }
    return 0;
}

int libusb_cancel_transfer(struct libusb_transfer *transfer) {
    const int code = fails("libusb_cancel_transfer");
    const unsigned at = place_of(transfer);
    if (code != 0 || at == pending_count || pending[at].cancelled) {
        return code != 0 ? code : LIBUSB_ERROR_NOT_FOUND;
    }
    pending[at].cancelled = true;
    return 0;
}

/// What the device makes of it: bytes; -1: refused; -2: later.
static int carry_out(const struct libusb_model *model, struct libusb_transfer *transfer) {
    if (transfer->type != LIBUSB_TRANSFER_TYPE_CONTROL) {
        const uint8_t number = transfer->endpoint & 15U;
        const uint32_t size = (uint32_t)transfer->length;
        return (transfer->endpoint & LIBUSB_ENDPOINT_IN) != 0U
                   ? model->bulk_in(model->ctx, number, transfer->buffer, size)
                   : model->bulk_out(model->ctx, number, transfer->buffer, size);
    }
    uint8_t answer[512];
    uint8_t *const data = transfer->buffer + LIBUSB_CONTROL_SETUP_SIZE;
    const bool in = (transfer->buffer[0] & LIBUSB_ENDPOINT_IN) != 0U;
    const int room = transfer->length - (int)LIBUSB_CONTROL_SETUP_SIZE;
    const int count =
        model->control(model->ctx, transfer->buffer, in ? answer : data, (uint16_t)room);
    if (count < 0 || !in) {
        return count < 0 ? count : room;
    }
    const int taken = count < room ? count : room;
    memcpy(data, answer, (size_t)taken);
    return taken;
}

/// Whether it ends now.
static bool ends(struct pending *at) {
    struct libusb_transfer *transfer = at->transfer;
    const struct libusb_model *model = plugged[transfer->dev_handle->device->number];
    transfer->actual_length = 0;
    if (libusb_model_faults.stuck) {
        return false;
    }
    if (model == NULL || at->cancelled) {
        transfer->status = model == NULL ? LIBUSB_TRANSFER_NO_DEVICE : LIBUSB_TRANSFER_CANCELLED;
        return true;
    }
    if (libusb_model_faults.spoil_next > 0U) {
        libusb_model_faults.spoil_next--;
        transfer->status = (enum libusb_transfer_status)libusb_model_faults.spoil_with;
        return true;
    }
    const int count = carry_out(model, transfer);
    transfer->status = count == -1 ? LIBUSB_TRANSFER_STALL : LIBUSB_TRANSFER_COMPLETED;
    transfer->actual_length = count > 0 ? count : 0;
    if (count == -2 && transfer->timeout != 0U && ++at->looks >= transfer->timeout) {
        transfer->status = LIBUSB_TRANSFER_TIMED_OUT;
        return true;
    }
    return count != -2;
}

int libusb_handle_events_timeout_completed(libusb_context *context, struct timeval *patience,
                                           int *completed) {
    (void)context;
    (void)patience;
    (void)completed;
    const int code = fails("libusb_handle_events");
    for (unsigned i = 0; i < pending_count && code == 0;) {
        if (!ends(&pending[i])) {
            i++;
            continue;
        }
        struct libusb_transfer *const ended = pending[i].transfer;
        pending_count--;
        memmove(&pending[i], &pending[i + 1U], (pending_count - i) * sizeof *pending);
        ended->callback(ended);
    }
    return code;
}

const char *libusb_strerror(int code) {
    return code == LIBUSB_ERROR_IO ? "Input/Output Error" : "another error";
}

const struct libusb_version *libusb_get_version(void) {
    static const struct libusb_version version = {1, 0, 99, 0, "", "model"};
    return &version;
}

#else

struct libusb_model_faults libusb_model_faults;

void libusb_model_plug(unsigned number, const struct libusb_model *model) {
    (void)number;
    (void)model;
}

unsigned libusb_model_objects(void) {
    return 0;
}

#endif

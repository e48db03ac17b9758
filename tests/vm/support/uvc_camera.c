#include "vm/support/uvc_camera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#if HAVE_JPEG
#include <jpeglib.h>
#endif

#define PAYLOAD_BYTES 16384U
#define HEADER_BYTES  2U
#define FORMATS       3U
#define INTERVALS     3U

static const uint32_t interval_100ns[INTERVALS] = {333333, 1000000, 2000000};
static const uint32_t sizes[2][2] = {{UVC_CAMERA_WIDTH, UVC_CAMERA_HEIGHT},
                                     {UVC_CAMERA_WIDTH / 2U, UVC_CAMERA_HEIGHT / 2U}};

// ---------------------------------------------------------------- descriptors

static const uint8_t device_descriptor[18] = {18,   1, 0,    2, 0xEF, 2, 1, 64, 0x09,
                                              0x12, 1, 0x5C, 0, 1,    1, 2, 3,  1};

/// Descriptors one after another; each begins with its length.
struct list {
    uint8_t bytes[512];
    size_t size;
};

static void put(struct list *list, unsigned width, uint32_t value) {
    for (unsigned i = 0; i < width; i++) {
        list->bytes[list->size++] = (uint8_t)(value >> 8U * i);
    }
}

static void put_bytes(struct list *list, const uint8_t *bytes, size_t count) {
    memcpy(list->bytes + list->size, bytes, count);
    list->size += count;
}

/// Fills in a length of what begins at a place and ends here.
static void put_length(struct list *list, size_t begin, size_t at, unsigned width) {
    const size_t end = list->size, length = end - begin;
    list->size = at;
    put(list, width, (uint32_t)length);
    list->size = end;
}

static void put_control_interface(struct list *list) {
    static const uint8_t interface[] = {9, 4, 0, 0, 0, 0x0E, 1, 0, 0};
    // Camera terminal 1 (zoom, bit 9, and pan and tilt, bit 11, can be set) and USB terminal 3.
    static const uint8_t camera[] = {18, 0x24, 2, 1, 1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0x0A, 0};
    static const uint8_t output[] = {9, 0x24, 3, 3, 1, 1, 0, 1, 0};
    put_bytes(list, interface, sizeof interface);
    const size_t header = list->size;
    static const uint8_t head[] = {13, 0x24, 1, 0, 1, 0, 0, 0x00, 0x6C, 0xDC, 0x02, 1, 1};
    put_bytes(list, head, sizeof head);
    put_bytes(list, camera, sizeof camera);
    put_bytes(list, output, sizeof output);
    put_length(list, header, header + 5U, 2);
}

static void put_frames(struct list *list, uint8_t subtype, uint32_t bytes_a_pixel) {
    for (uint32_t i = 0; i < 2U; i++) {
        const uint32_t bytes = sizes[i][0] * sizes[i][1] * bytes_a_pixel;
        put(list, 1, 26U + 4U * INTERVALS);
        put(list, 1, 0x24);
        put(list, 1, subtype);
        put(list, 1, i + 1U);
        put(list, 1, 0);
        put(list, 2, sizes[i][0]);
        put(list, 2, sizes[i][1]);
        put(list, 4, bytes * 8U * 5U);
        put(list, 4, bytes * 8U * 30U);
        put(list, 4, bytes);
        put(list, 4, interval_100ns[0]);
        put(list, 1, INTERVALS);
        for (uint32_t k = 0; k < INTERVALS; k++) {
            put(list, 4, interval_100ns[k]);
        }
    }
}

static void put_plain_format(struct list *list, uint8_t index, const char *name,
                             uint32_t bytes_a_pixel) {
    static const uint8_t guid_end[] = {0, 0, 0x10, 0, 0x80, 0, 0, 0xAA, 0, 0x38, 0x9B, 0x71};
    put(list, 1, 27);
    put(list, 1, 0x24);
    put(list, 1, 4);
    put(list, 1, index);
    put(list, 1, 2);
    put_bytes(list, (const uint8_t *)name, 4);
    put_bytes(list, guid_end, sizeof guid_end);
    put(list, 1, 8U * bytes_a_pixel);
    put(list, 1, 1);
    put(list, 4, 0);
    put_frames(list, 5, bytes_a_pixel);
}

static void put_streaming_interface(struct list *list) {
    static const uint8_t interface[] = {9, 4, 1, 0, 1, 0x0E, 2, 0, 0};
    static const uint8_t head[] = {
        13U + FORMATS, 0x24, 1, FORMATS, 0, 0, 0x81, 0, 3, 0, 0, 0, 1, 0, 0, 0};
    static const uint8_t jpeg[] = {11, 0x24, 6, 3, 2, 1, 1, 0, 0, 0, 0};
    static const uint8_t endpoint[] = {7, 5, 0x81, 2, 0, 2, 0};
    put_bytes(list, interface, sizeof interface);
    const size_t header = list->size;
    put_bytes(list, head, sizeof head);
    put_plain_format(list, 1, "YUY2", 2);
    put_plain_format(list, 2, "Y800", 1);
    put_bytes(list, jpeg, sizeof jpeg);
    put_frames(list, 7, 2);
    put_length(list, header, header + 4U, 2);
    put_bytes(list, endpoint, sizeof endpoint);
}

static const uint8_t *configuration(void) {
    static struct list list;
    static const uint8_t head[] = {9, 2, 0, 0, 2, 1, 0, 0x80, 50};
    static const uint8_t association[] = {8, 11, 0, 2, 0x0E, 3, 0, 0};
    list.size = 0;
    put_bytes(&list, head, sizeof head);
    put_bytes(&list, association, sizeof association);
    put_control_interface(&list);
    put_streaming_interface(&list);
    put_length(&list, 0, 2, 2);
    return list.bytes;
}

// ---------------------------------------------------------------- requests

static uint32_t get(const uint8_t *bytes, unsigned width) {
    uint32_t value = 0;
    for (unsigned i = 0; i < width; i++) {
        value |= (uint32_t)bytes[i] << 8U * i;
    }
    return value;
}

static void set(uint8_t *bytes, unsigned width, uint32_t value) {
    for (unsigned i = 0; i < width; i++) {
        bytes[i] = (uint8_t)(value >> 8U * i);
    }
}

static uint64_t now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000U + (uint64_t)now.tv_nsec / 1000U;
}

/// What the host would like, made into something that the camera has.
static void negotiate(struct uvc_camera *camera, const uint8_t *wish) {
    const uint32_t format = wish[2] >= 1U && wish[2] <= FORMATS ? wish[2] : 1U;
    const uint32_t frame = wish[3] >= 1U && wish[3] <= 2U ? wish[3] : 1U;
    uint32_t interval = interval_100ns[0];
    for (uint32_t i = 0; i < INTERVALS; i++) {
        interval = get(wish + 4, 4) >= interval_100ns[i] ? interval_100ns[i] : interval;
    }
    uint8_t *const probe = camera->probe;
    set(probe, 2, get(wish, 2));
    set(probe + 2, 1, format);
    set(probe + 3, 1, frame);
    set(probe + 4, 4, interval);
    set(probe + 18, 4, sizes[frame - 1U][0] * sizes[frame - 1U][1] * (format == 2U ? 1U : 2U));
    set(probe + 22, 4, PAYLOAD_BYTES);
}

static int stream_request(struct uvc_camera *camera, uint8_t request, uint8_t selector,
                          uint8_t *data) {
    switch (request) {
    case 0x01:
        negotiate(camera, data);
        if (selector == 2U) { // committed: it streams as soon as transfers wait
            const uint8_t *const frame = camera->probe;
            camera->format = frame[2];
            camera->width_px = sizes[frame[3] - 1U][0];
            camera->height_px = sizes[frame[3] - 1U][1];
            camera->interval_us = get(frame + 4, 4) / 10U;
            camera->due_us = now_us() + camera->interval_us;
            camera->sending = false;
            camera->starts++;
        }
        return 0;
    case 0x86:
        data[0] = 3;
        return 1;
    default:
        memcpy(data, camera->probe, sizeof camera->probe);
        return (int)sizeof camera->probe;
    }
}

/// Of a control: what a GET request is answered with.
static int32_t answer_of(uint8_t request, int32_t now, int32_t min, int32_t max, int32_t step,
                         int32_t initial) {
    switch (request) {
    case 0x81:
        return now;
    case 0x82:
        return min;
    case 0x83:
        return max;
    case 0x84:
        return step;
    default:
        return initial;
    }
}

static int set_control(struct uvc_camera *camera, bool zoom, const uint8_t *data) {
    usleep(camera->slow_us);
    if (camera->refuse_next > 0U) {
        camera->refuse_next--;
        return USB_MODEL_STALL;
    }
    if (zoom) {
        camera->zoom = (int32_t)get(data, 2);
    } else {
        camera->pan = (int32_t)get(data, 4);
        camera->tilt = (int32_t)get(data + 4, 4);
    }
    camera->settings++;
    return 0;
}

static int camera_request(struct uvc_camera *camera, uint8_t request, uint8_t selector,
                          uint8_t *data) {
    const int32_t most = UVC_CAMERA_PAN_MAX, step = UVC_CAMERA_PAN_STEP;
    const bool zoom = selector == 0x0BU;
    if (selector != 0x0DU && !zoom) {
        return USB_MODEL_STALL;
    }
    if (request == 0x01U) {
        return set_control(camera, zoom, data);
    }
    if (request == 0x86U) {
        data[0] = 3;
        return 1;
    }
    if (zoom) {
        set(data, 2,
            (uint32_t)answer_of(request, camera->zoom, UVC_CAMERA_ZOOM_MIN, UVC_CAMERA_ZOOM_MAX, 1,
                                UVC_CAMERA_ZOOM_MIN));
        return 2;
    }
    set(data, 4, (uint32_t)answer_of(request, camera->pan, -most, most, step, 0));
    set(data + 4, 4, (uint32_t)answer_of(request, camera->tilt, -most / 3, most / 3, step, 0));
    return 8;
}

static int control(void *ctx, const uint8_t setup[8], uint8_t *data, uint16_t size) {
    struct uvc_camera *camera = ctx;
    (void)size;
    if (camera->refuses || (setup[0] & 0x7FU) != 0x21U) {
        return USB_MODEL_STALL;
    }
    const uint8_t interface = setup[4], entity = setup[5], selector = setup[3];
    if (interface == 1U) {
        return stream_request(camera, setup[1], selector, data);
    }
    return entity == 1U ? camera_request(camera, setup[1], selector, data) : USB_MODEL_STALL;
}

// ---------------------------------------------------------------- pictures

#if HAVE_JPEG
static uint32_t to_jpeg(struct uvc_camera *camera) {
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    uint8_t *out = camera->frame;
    unsigned long size = sizeof camera->frame;
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &out, &size);
    jpeg.image_width = camera->width_px;
    jpeg.image_height = camera->height_px;
    jpeg.input_components = 1;
    jpeg.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg);
    jpeg_start_compress(&jpeg, TRUE);
    while (jpeg.next_scanline < jpeg.image_height) {
        JSAMPROW line = camera->luma + (size_t)jpeg.next_scanline * jpeg.image_width;
        (void)jpeg_write_scanlines(&jpeg, &line, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    return (uint32_t)size;
}
#else
static uint32_t to_jpeg(struct uvc_camera *camera) {
    (void)camera;
    return 0;
}
#endif

static void begin_frame(struct uvc_camera *camera) {
    const uint32_t count = camera->width_px * camera->height_px;
    if (camera->paint != NULL) {
        camera->paint(camera->ctx, camera, camera->luma);
    } else {
        memset(camera->luma, (int)(camera->frames & 255U), count);
    }
    if (camera->format == 3U) {
        camera->frame_bytes = to_jpeg(camera);
    } else {
        const uint32_t step = camera->format == 1U ? 2U : 1U;
        memset(camera->frame, 128, count * step);
        for (uint32_t i = 0; i < count; i++) {
            camera->frame[i * step] = camera->luma[i];
        }
        camera->frame_bytes = count * step;
    }
    camera->tearing = camera->tear_next > 0U;
    camera->tear_next -= camera->tearing ? 1U : 0U;
    camera->spoiling = camera->spoil_next > 0U;
    camera->spoil_next -= camera->spoiling ? 1U : 0U;
    camera->sent_bytes = 0;
    camera->sending = true;
    camera->frames++;
    camera->id = !camera->id;
}

/// One payload: its header, and as much of the picture as it holds.
static int bulk_in(void *ctx, uint8_t endpoint, uint8_t *data, uint32_t capacity) {
    struct uvc_camera *camera = ctx;
    (void)endpoint;
    if (!camera->sending) {
        const uint64_t now = now_us();
        if (camera->silent || now < camera->due_us ||
            (camera->ready != NULL && !camera->ready(camera->ctx))) {
            return USB_MODEL_LATER;
        }
        camera->due_us += camera->interval_us;
        if (camera->due_us < now) { // never in a burst
            camera->due_us = now + camera->interval_us;
        }
        begin_frame(camera);
    }
    uint32_t count = camera->frame_bytes - camera->sent_bytes;
    count = count < capacity - HEADER_BYTES ? count : capacity - HEADER_BYTES;
    bool last = camera->sent_bytes + count == camera->frame_bytes;
    if (camera->tearing) {
        count /= 2U;
        last = true;
    }
    data[0] = HEADER_BYTES;
    data[1] = (uint8_t)(0x80U | (camera->id ? 1U : 0U) | (last ? 2U : 0U) |
                        (camera->spoiling ? 0x40U : 0U));
    memcpy(data + HEADER_BYTES, camera->frame + camera->sent_bytes, count);
    camera->sent_bytes += count;
    camera->sending = !last;
    return (int)(count + HEADER_BYTES);
}

static int bulk_out(void *ctx, uint8_t endpoint, const uint8_t *data, uint32_t size) {
    (void)ctx;
    (void)endpoint;
    (void)data;
    (void)size;
    return USB_MODEL_STALL;
}

// ---------------------------------------------------------------- plugging

void uvc_camera_init(struct uvc_camera *camera) {
    memset(camera, 0, sizeof *camera);
    camera->zoom = UVC_CAMERA_ZOOM_MIN;
    const uint8_t wish[26] = {0, 0, 1, 1};
    negotiate(camera, wish);
}

void uvc_camera_plug(struct usb_port *port, unsigned number, struct uvc_camera *camera) {
    const struct usb_model model = {.device = device_descriptor,
                                    .configuration = configuration(),
                                    .strings = {"Boresight", UVC_CAMERA_NAME, "0001"},
                                    .speed = USB_HIGH_SPEED,
                                    .ctx = camera,
                                    .control = control,
                                    .bulk_out = bulk_out,
                                    .bulk_in = bulk_in};
    camera->sending = false;
    usb_port_plug(port, number, &model);
}

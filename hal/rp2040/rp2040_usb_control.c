#include "rp2040/rp2040_usb_private.h"

/// Requests: USB 2.0, table 9-4; PSTN subclass, table 13.
enum request {
    GET_STATUS = 0x8000,
    CLEAR_FEATURE_ENDPOINT = 0x0201,
    SET_ADDRESS = 0x0005,
    GET_DESCRIPTOR = 0x8006,
    GET_CONFIGURATION = 0x8008,
    SET_CONFIGURATION = 0x0009,
    SET_INTERFACE = 0x010B,
    SET_LINE_CODING = 0x2120,
    GET_LINE_CODING = 0xA121,
    SET_CONTROL_LINE_STATE = 0x2122
};
enum { DESCRIPTOR_DEVICE = 1, DESCRIPTOR_CONFIGURATION = 2, DESCRIPTOR_STRING = 3 };
enum { STRING_LANGUAGES, STRING_MAKER, STRING_PRODUCT };

#define LOW_HIGH(value) (value) & 0xFF, (value) >> 8
/// pid.codes' number for tests, which anybody may use for devices that are not sold.
#define VENDOR  0x1209
#define PRODUCT 0x0001

/// USB 2.0, table 9-8. Class 2: communications.
static const uint8_t device_descriptor[] = {18,
                                            DESCRIPTOR_DEVICE,
                                            LOW_HIGH(0x0200),
                                            2,
                                            0,
                                            0,
                                            RP2040_USB_PACKET_BYTES,
                                            LOW_HIGH(VENDOR),
                                            LOW_HIGH(PRODUCT),
                                            LOW_HIGH(0x0100),
                                            STRING_MAKER,
                                            STRING_PRODUCT,
                                            0,
                                            1};

/// USB 2.0, tables 9-10, 9-12, 9-13; CDC 1.2, 5.2.3; PSTN subclass, 5.3.
#define CONFIGURATION_BYTES 67
static const uint8_t configuration_descriptor[] = {
    9,
    DESCRIPTOR_CONFIGURATION,
    LOW_HIGH(CONFIGURATION_BYTES),
    2,
    1,
    0,
    0x80,
    250, // 500 mA
    9,
    4,
    0,
    0,
    1,
    2,
    2,
    0,
    0, // interface 0: communications, abstract control model
    5,
    0x24,
    0x00,
    0x10,
    0x01, // CDC 1.10
    5,
    0x24,
    0x01,
    0x00,
    1, // calls: not managed
    4,
    0x24,
    0x02,
    0x02, // understands line coding and line state
    5,
    0x24,
    0x06,
    0,
    1, // control is interface 0, data interface 1
    7,
    5,
    0x80 | RP2040_USB_EP_NOTICES,
    3,
    LOW_HIGH(8),
    255, // in, interrupt
    9,
    4,
    1,
    0,
    2,
    10,
    0,
    0,
    0, // interface 1: data
    7,
    5,
    RP2040_USB_EP_DATA,
    2,
    LOW_HIGH(RP2040_USB_PACKET_BYTES),
    0, // out, bulk
    7,
    5,
    0x80 | RP2040_USB_EP_DATA,
    2,
    LOW_HIGH(RP2040_USB_PACKET_BYTES),
    0};
_Static_assert(sizeof configuration_descriptor == CONFIGURATION_BYTES, "the length it tells");

struct setup {
    enum request request; ///< bmRequestType and bRequest
    uint32_t value, index, length;
};

static struct setup read_setup(void) {
    const volatile uint8_t *at = RP2040_USB_MEMORY->setup;
    return (struct setup){(enum request)(at[0] << 8 | at[1]), at[2] | (uint32_t)at[3] << 8,
                          at[4] | (uint32_t)at[5] << 8, at[6] | (uint32_t)at[7] << 8};
}

// ---------------------------------------------------------------- stages

static void send_reply(struct rp2040_usb *usb) {
    const uint32_t count =
        usb->reply_bytes < RP2040_USB_PACKET_BYTES ? usb->reply_bytes : RP2040_USB_PACKET_BYTES;
    for (uint32_t i = 0; i < count; i++) {
        RP2040_USB_MEMORY->data[i] = usb->reply[i];
    }
    usb->reply += count;
    usb->reply_bytes -= count;
    usb->stage = usb->reply_bytes != 0U ? RP2040_USB_STAGE_REPLY : RP2040_USB_STAGE_NONE;
    rp2040_usb_hand_over(RP2040_USB_EP_CONTROL, RP2040_USB_IN, RP2040_USB_BUFFER_FULL,
                         usb->reply_data1, count);
    usb->reply_data1 = !usb->reply_data1;
}

/// In packets, as far as it was asked for. No reply is a multiple of a packet long, which would
/// need an empty one at its end. The computer ends the request with an empty packet, at any time.
static void reply(struct rp2040_usb *usb, const struct setup *setup, const uint8_t *data,
                  uint32_t size_bytes) {
    usb->reply = data;
    usb->reply_bytes = size_bytes < setup->length ? size_bytes : setup->length;
    rp2040_usb_hand_over(RP2040_USB_EP_CONTROL, RP2040_USB_OUT, 0, true, 0);
    send_reply(usb);
}

static void acknowledge(void) {
    rp2040_usb_hand_over(RP2040_USB_EP_CONTROL, RP2040_USB_IN, RP2040_USB_BUFFER_FULL, true, 0);
}

/// "I don't know that": until the next request.
static void refuse(void) {
    RP2040_USB->stall_arm = RP2040_USB_STALL_EP0;
    RP2040_USB_MEMORY->buffer[RP2040_USB_EP_CONTROL][RP2040_USB_IN] = RP2040_USB_BUFFER_STALL;
    RP2040_USB_MEMORY->buffer[RP2040_USB_EP_CONTROL][RP2040_USB_OUT] = RP2040_USB_BUFFER_STALL;
}

// ---------------------------------------------------------------- requests

static void reply_string(struct rp2040_usb *usb, const struct setup *setup, unsigned number) {
    static const char *const strings[] = {
        [STRING_MAKER] = "Boresight", [STRING_PRODUCT] = "Boresight gimbal"};
    uint32_t size = 2;
    if (number == STRING_LANGUAGES) {
        usb->string[size++] = 0x09; // English, United States
        usb->string[size++] = 0x04;
    } else if (number <= STRING_PRODUCT) {
        for (const char *c = strings[number]; *c != '\0'; c++) {
            usb->string[size++] = (uint8_t)*c;
            usb->string[size++] = 0;
        }
    } else {
        refuse();
        return;
    }
    usb->string[0] = (uint8_t)size;
    usb->string[1] = DESCRIPTOR_STRING;
    reply(usb, setup, usb->string, size);
}

static void reply_descriptor(struct rp2040_usb *usb, const struct setup *setup) {
    switch (setup->value >> 8) {
    case DESCRIPTOR_DEVICE:
        reply(usb, setup, device_descriptor, sizeof device_descriptor);
        break;
    case DESCRIPTOR_CONFIGURATION:
        reply(usb, setup, configuration_descriptor, sizeof configuration_descriptor);
        break;
    case DESCRIPTOR_STRING:
        reply_string(usb, setup, setup->value & 0xFFU);
        break;
    default:
        refuse();
    }
}

/// Short replies are made in the buffer of strings.
static void reply_bytes(struct rp2040_usb *usb, const struct setup *setup, uint8_t first,
                        uint32_t size_bytes) {
    usb->string[0] = first;
    usb->string[1] = 0;
    reply(usb, setup, usb->string, size_bytes);
}

/// Bit 0 of the line state is "data terminal ready": a program has opened the port.
static void set_line_state(struct rp2040_usb *usb, uint32_t state) {
    const bool open = usb->configured && (state & 1U) != 0U;
    if (!open) {
        cortexm_ring_clear(&usb->sending);
    }
    usb->open = open;
}

void rp2040_usb_on_setup(struct rp2040_usb *usb) {
    const struct setup setup = read_setup();
    usb->stage = RP2040_USB_STAGE_NONE;
    usb->reply_data1 = true;
    switch (setup.request) {
    case GET_DESCRIPTOR:
        reply_descriptor(usb, &setup);
        return;
    case GET_STATUS:
        reply_bytes(usb, &setup, 0, 2);
        return;
    case GET_CONFIGURATION:
        reply_bytes(usb, &setup, usb->configured, 1);
        return;
    case GET_LINE_CODING:
        reply(usb, &setup, usb->coding, sizeof usb->coding);
        return;
    case SET_LINE_CODING:
        usb->stage = RP2040_USB_STAGE_CODING;
        rp2040_usb_hand_over(RP2040_USB_EP_CONTROL, RP2040_USB_OUT, 0, true,
                             RP2040_USB_PACKET_BYTES);
        return;
    case SET_ADDRESS:
        usb->address = setup.value & 0x7FU;
        usb->stage = RP2040_USB_STAGE_ADDRESS; // the answer still goes out from the old one
        break;
    case SET_CONFIGURATION:
        rp2040_usb_configure(usb, setup.value != 0U);
        break;
    case SET_CONTROL_LINE_STATE:
        set_line_state(usb, setup.value);
        break;
    case CLEAR_FEATURE_ENDPOINT:
        if ((setup.index & 0x7FU) == RP2040_USB_EP_DATA) {
            rp2040_usb_restart(usb, setup.index >> 7 == 0U ? RP2040_USB_OUT : RP2040_USB_IN);
        }
        break;
    case SET_INTERFACE:
        break;
    default:
        refuse();
        return;
    }
    acknowledge();
}

void rp2040_usb_on_control(struct rp2040_usb *usb, unsigned direction) {
    if (direction == RP2040_USB_IN && usb->stage == RP2040_USB_STAGE_ADDRESS) {
        RP2040_USB->address = usb->address;
        usb->stage = RP2040_USB_STAGE_NONE;
    } else if (direction == RP2040_USB_IN && usb->stage == RP2040_USB_STAGE_REPLY) {
        send_reply(usb);
    } else if (direction == RP2040_USB_OUT && usb->stage == RP2040_USB_STAGE_CODING) {
        for (unsigned i = 0; i < sizeof usb->coding; i++) {
            usb->coding[i] = RP2040_USB_MEMORY->data[i];
        }
        usb->stage = RP2040_USB_STAGE_NONE;
        acknowledge();
    }
}

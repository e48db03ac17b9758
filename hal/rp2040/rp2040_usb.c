#include "rp2040/rp2040_usb.h"

#include "rp2040/rp2040_usb_private.h"

/// Places in the shared memory's data, from its address 0x100 on, which is endpoint 0's
/// (4.1.2.5.1).
enum { NOTICES_AT = 0x80, RECEIVE_AT = 0xC0, SEND_AT = 0x100, DATA_ADDRESS = 0x100 };

/// A packet of full size says that more follows, and some computers then wait for it.
#define SEND_PACKET_BYTES (RP2040_USB_PACKET_BYTES - 1U)

// ---------------------------------------------------------------- the program's side

/// Calls the handler, by an interrupt that a device never has.
static void call_handler(void) {
    cortexm_barrier();
    RP2040_USB->force = RP2040_USB_INTERRUPT_HOST_ONLY;
}

enum hal_status rp2040_usb_write(struct rp2040_usb *usb, const uint8_t *data, size_t size_bytes,
                                 size_t *written_bytes) {
    *written_bytes = 0;
    if (!usb->open) {
        return HAL_ERROR_GONE;
    }
    size_t count = 0;
    while (count < size_bytes && cortexm_ring_count(&usb->sending) < RP2040_USB_SEND_BYTES) {
        usb->send_bytes[usb->sending.put % RP2040_USB_SEND_BYTES] = data[count++];
        cortexm_ring_put(&usb->sending);
    }
    *written_bytes = count;
    if (count == 0U) {
        return HAL_BUSY;
    }
    call_handler();
    return HAL_OK;
}

enum hal_status rp2040_usb_read(struct rp2040_usb *usb, uint8_t *data, size_t capacity_bytes,
                                size_t *read_bytes) {
    size_t count = 0;
    while (count < capacity_bytes && cortexm_ring_count(&usb->received) != 0U) {
        data[count++] = usb->receive_bytes[usb->received.taken % RP2040_USB_RECEIVE_BYTES];
        cortexm_ring_take(&usb->received);
    }
    *read_bytes = count;
    if (count == 0U) {
        return HAL_EMPTY;
    }
    call_handler(); // there may be room for a packet again
    return HAL_OK;
}

// ---------------------------------------------------------------- packets

/// 4.1.2.5.1: the hardware may look at the word while it is written, in a clock of its own, so the
/// bit that gives the buffer away comes later than the others: 12 cycles of the core are more than
/// one of 48 MHz up to 576 MHz.
void rp2040_usb_hand_over(unsigned endpoint, unsigned direction, uint32_t more, bool data1,
                          uint32_t size_bytes) {
    volatile uint32_t *control = &RP2040_USB_MEMORY->buffer[endpoint][direction];
    const uint32_t word = more | (data1 ? (uint32_t)RP2040_USB_BUFFER_DATA1 : 0U) | size_bytes;
    *control = word;
    for (unsigned i = 0; i < 4U; i++) {
        __asm volatile("nop\n\tnop\n\tnop");
    }
    *control = word | RP2040_USB_BUFFER_AVAILABLE;
}

static void send_more(struct rp2040_usb *usb) {
    uint32_t count = cortexm_ring_count(&usb->sending);
    if (usb->sends || count == 0U) {
        return;
    }
    count = count < SEND_PACKET_BYTES ? count : SEND_PACKET_BYTES;
    for (uint32_t i = 0; i < count; i++) {
        RP2040_USB_MEMORY->data[SEND_AT + i] =
            usb->send_bytes[usb->sending.taken % RP2040_USB_SEND_BYTES];
        cortexm_ring_take(&usb->sending);
    }
    usb->sends = true;
    rp2040_usb_hand_over(RP2040_USB_EP_DATA, RP2040_USB_IN, RP2040_USB_BUFFER_FULL, usb->send_data1,
                         count);
    usb->send_data1 = !usb->send_data1;
}

static void receive_more(struct rp2040_usb *usb) {
    if (usb->receives ||
        RP2040_USB_RECEIVE_BYTES - cortexm_ring_count(&usb->received) < RP2040_USB_PACKET_BYTES) {
        return;
    }
    usb->receives = true;
    rp2040_usb_hand_over(RP2040_USB_EP_DATA, RP2040_USB_OUT, 0, usb->receive_data1,
                         RP2040_USB_PACKET_BYTES);
    usb->receive_data1 = !usb->receive_data1;
}

/// There is room for a packet, or the buffer would not have been the hardware's.
static void take_received(struct rp2040_usb *usb) {
    const uint32_t count =
        RP2040_USB_MEMORY->buffer[RP2040_USB_EP_DATA][RP2040_USB_OUT] & RP2040_USB_BUFFER_LENGTH;
    for (uint32_t i = 0; i < count && i < RP2040_USB_PACKET_BYTES; i++) {
        usb->receive_bytes[usb->received.put % RP2040_USB_RECEIVE_BYTES] =
            RP2040_USB_MEMORY->data[RECEIVE_AT + i];
        cortexm_ring_put(&usb->received);
    }
    usb->receives = false;
}

static void set_endpoint(unsigned endpoint, unsigned direction, uint32_t kind, uint32_t at) {
    RP2040_USB_MEMORY->endpoint[endpoint - 1U][direction] =
        RP2040_USB_ENDPOINT_ENABLE | RP2040_USB_ENDPOINT_INTERRUPT | kind | (DATA_ADDRESS + at);
}

void rp2040_usb_restart(struct rp2040_usb *usb, unsigned direction) {
    RP2040_USB_MEMORY->buffer[RP2040_USB_EP_DATA][direction] = 0;
    if (direction == RP2040_USB_IN) {
        usb->sends = usb->send_data1 = false;
    } else {
        usb->receives = usb->receive_data1 = false;
    }
}

void rp2040_usb_configure(struct rp2040_usb *usb, bool on) {
    usb->configured = on;
    usb->open = false;
    cortexm_ring_clear(&usb->sending);
    rp2040_usb_restart(usb, RP2040_USB_IN);
    rp2040_usb_restart(usb, RP2040_USB_OUT);
    if (on) {
        set_endpoint(RP2040_USB_EP_NOTICES, RP2040_USB_IN, RP2040_USB_ENDPOINT_NOTICES, NOTICES_AT);
        set_endpoint(RP2040_USB_EP_DATA, RP2040_USB_IN, RP2040_USB_ENDPOINT_BULK, SEND_AT);
        set_endpoint(RP2040_USB_EP_DATA, RP2040_USB_OUT, RP2040_USB_ENDPOINT_BULK, RECEIVE_AT);
    }
}

// ---------------------------------------------------------------- interrupt and start

static void on_reset(struct rp2040_usb *usb) {
    RP2040_USB->address = 0;
    usb->stage = RP2040_USB_STAGE_NONE;
    rp2040_usb_configure(usb, false);
}

static void on_buffers(struct rp2040_usb *usb, uint32_t done) {
    for (unsigned direction = RP2040_USB_IN; direction <= RP2040_USB_OUT; direction++) {
        if ((done >> direction & 1U) != 0U) {
            rp2040_usb_on_control(usb, direction);
        }
    }
    const uint32_t data = done >> (2U * RP2040_USB_EP_DATA);
    if ((data >> RP2040_USB_IN & 1U) != 0U) {
        usb->sends = false;
    }
    if ((data >> RP2040_USB_OUT & 1U) != 0U && usb->receives) {
        take_received(usb);
    }
}

void rp2040_usb_on_interrupt(struct rp2040_usb *usb) {
    RP2040_USB->force = 0; // before the rings are looked at
    const uint32_t status = RP2040_USB->status;
    if ((status & RP2040_USB_INTERRUPT_RESET) != 0U) {
        RP2040_USB->line_status = RP2040_USB_LINE_STATUS_RESET;
        on_reset(usb);
    }
    // Buffers first: what they end came before the request.
    if ((status & RP2040_USB_INTERRUPT_BUFFERS) != 0U) {
        const uint32_t done = RP2040_USB->buffers_done;
        RP2040_USB->buffers_done = done;
        on_buffers(usb, done);
    }
    if ((status & RP2040_USB_INTERRUPT_SETUP) != 0U) {
        RP2040_USB->line_status = RP2040_USB_LINE_STATUS_SETUP;
        rp2040_usb_on_setup(usb);
    }
    if (usb->configured) {
        send_more(usb);
        receive_more(usb);
    }
}

void rp2040_usb_init(struct rp2040_usb *usb) {
    *usb = (struct rp2040_usb){.coding = {0x00, 0xC2, 0x01, 0x00, 0, 0, 8}}; // 115200 8N1
    for (unsigned endpoint = 0; endpoint < 16U; endpoint++) {
        for (unsigned direction = RP2040_USB_IN; direction <= RP2040_USB_OUT; direction++) {
            RP2040_USB_MEMORY->buffer[endpoint][direction] = 0;
            if (endpoint != 0U) {
                RP2040_USB_MEMORY->endpoint[endpoint - 1U][direction] = 0;
            }
        }
    }
    RP2040_USB->muxing = RP2040_USB_MUXING_PHY | RP2040_USB_MUXING_SOFT;
    RP2040_USB->power = RP2040_USB_POWER_DETECT | RP2040_USB_POWER_DETECT_OVERRIDE;
    RP2040_USB->control = RP2040_USB_CONTROL_ENABLE;
    RP2040_USB->line_control = RP2040_USB_LINE_CONTROL_EP0_INTERRUPT;
    RP2040_USB->enable =
        RP2040_USB_INTERRUPT_BUFFERS | RP2040_USB_INTERRUPT_RESET | RP2040_USB_INTERRUPT_SETUP;
    cortexm_irq_set_priority(RP2040_IRQ_USB, CORTEXM_PRIORITY_DEVICE);
    cortexm_irq_enable(RP2040_IRQ_USB);
    RP2040_SET(RP2040_USB->line_control) = RP2040_USB_LINE_CONTROL_PULL_UP;
}

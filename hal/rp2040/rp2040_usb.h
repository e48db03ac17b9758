/// A serial port over the chip's own USB plug: what a computer knows as /dev/ttyACM0 or a COM port.
///
/// A device of the class CDC ACM ("USB Class Definitions for Communications Devices" 1.2, PSTN
/// subclass 1.2), so that no driver is needed. All work is done in the interrupt handler; the
/// program only touches two rings. While no computer has the port open, what is written is refused
/// with HAL_ERROR_GONE. What arrives is never lost: without room the computer is told to wait.
/// Source: USB 2.0, chapter 9; RP2040 datasheet, 4.1.
///
/// On chips of stepping B0 and B1 (erratum RP2040-E5) the computer may not find the device when
/// other devices of the same hub are busy.
/// Shown: tests/mcu/rp2040/ (a computer as rp2040js plays it).
#ifndef RP2040_RP2040_USB_H
#define RP2040_RP2040_USB_H

#include "cortexm/cortexm_ring.h"
#include "hal/serial.h"

#include <stdbool.h>

#define RP2040_USB_PACKET_BYTES 64U

/// Powers of two; the first at least two packets.
#define RP2040_USB_RECEIVE_BYTES 512U
#define RP2040_USB_SEND_BYTES    1024U

/// 6.3.11 of the PSTN subclass: speed and framing, which mean nothing here but are remembered.
#define RP2040_USB_LINE_CODING_BYTES 7U

/// What endpoint 0 does after its next packet.
enum rp2040_usb_stage {
    RP2040_USB_STAGE_NONE,
    RP2040_USB_STAGE_ADDRESS, ///< take the new address
    RP2040_USB_STAGE_REPLY,   ///< send more of the reply
    RP2040_USB_STAGE_CODING   ///< take a line coding
};

struct rp2040_usb {
    struct cortexm_ring received, sending;
    volatile bool open; ///< a program on the computer has the port open
    // The handler's own.
    bool configured, sends, receives; ///< sends, receives: the buffer is the hardware's
    bool send_data1, receive_data1;   ///< the kind of the next packet
    enum rp2040_usb_stage stage;
    uint32_t address;
    const uint8_t *reply;
    uint32_t reply_bytes;
    bool reply_data1;
    uint8_t coding[RP2040_USB_LINE_CODING_BYTES];
    uint8_t string[RP2040_USB_PACKET_BYTES];
    uint8_t receive_bytes[RP2040_USB_RECEIVE_BYTES];
    uint8_t send_bytes[RP2040_USB_SEND_BYTES];
};

/// Connects to the bus. The clock of 48 MHz must run (rp2040_clocks_start).
void rp2040_usb_init(struct rp2040_usb *usb);

/// As hal_serial_write and hal_serial_read.
enum hal_status rp2040_usb_write(struct rp2040_usb *usb, const uint8_t *data, size_t size_bytes,
                                 size_t *written_bytes) MUST_CHECK;
enum hal_status rp2040_usb_read(struct rp2040_usb *usb, uint8_t *data, size_t capacity_bytes,
                                size_t *read_bytes) MUST_CHECK;

/// The handler of its interrupt, RP2040_IRQ_USB.
void rp2040_usb_on_interrupt(struct rp2040_usb *usb);

#endif

/// A serial port on UART0: 8N1, both directions through rings that the interrupt handler works
/// on.
/// Shown: tests/mcu/rp2040/pico.sh.
#ifndef RP2040_RP2040_UART_H
#define RP2040_RP2040_UART_H

#include "cortexm/cortexm_ring.h"
#include "hal/serial.h"
#include "rp2040/rp2040_registers.h"

/// Powers of two. At 115,200 baud 11.5 bytes arrive in a millisecond.
#define RP2040_UART_RECEIVE_BYTES 512U
#define RP2040_UART_SEND_BYTES    1024U

struct rp2040_uart {
    struct rp2040_uart_block *block;
    enum rp2040_irq irq;
    struct cortexm_ring received, sending;
    volatile uint32_t lost_count, damaged_count;
    uint8_t receive_bytes[RP2040_UART_RECEIVE_BYTES];
    uint8_t send_bytes[RP2040_UART_SEND_BYTES];
};

/// core_hz: a multiple of 1 MHz, at most 512. Pins are the caller's business.
void rp2040_uart_init(struct rp2040_uart *uart, struct rp2040_uart_block *block,
                      enum rp2040_irq irq, uint32_t core_hz, uint32_t baud);

/// As hal_serial_write and hal_serial_read.
enum hal_status rp2040_uart_write(struct rp2040_uart *uart, const uint8_t *data, size_t size_bytes,
                                  size_t *written_bytes) MUST_CHECK;
enum hal_status rp2040_uart_read(struct rp2040_uart *uart, uint8_t *data, size_t capacity_bytes,
                                 size_t *read_bytes) MUST_CHECK;

/// The handler of its interrupt.
void rp2040_uart_on_interrupt(struct rp2040_uart *uart);

#endif

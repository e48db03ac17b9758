#include "rp2040/rp2040_uart.h"

enum { LISTEN = RP2040_UART_INTERRUPT_RECEIVE | RP2040_UART_INTERRUPT_IDLE };

/// The handler is the only one that touches the block: the program tells it that there is work.
enum hal_status rp2040_uart_write(struct rp2040_uart *uart, const uint8_t *data, size_t size_bytes,
                                  size_t *written_bytes) {
    *written_bytes = 0;
    size_t count = 0;
    while (count < size_bytes && cortexm_ring_count(&uart->sending) < RP2040_UART_SEND_BYTES) {
        uart->send_bytes[uart->sending.put % RP2040_UART_SEND_BYTES] = data[count++];
        cortexm_ring_put(&uart->sending);
    }
    *written_bytes = count;
    if (count == 0U) {
        return HAL_BUSY;
    }
    cortexm_irq_pend(uart->irq);
    return HAL_OK;
}

enum hal_status rp2040_uart_read(struct rp2040_uart *uart, uint8_t *data, size_t capacity_bytes,
                                 size_t *read_bytes) {
    size_t count = 0;
    while (count < capacity_bytes && cortexm_ring_count(&uart->received) != 0U) {
        data[count++] = uart->receive_bytes[uart->received.taken % RP2040_UART_RECEIVE_BYTES];
        cortexm_ring_take(&uart->received);
    }
    *read_bytes = count;
    return count != 0U ? HAL_OK : HAL_EMPTY;
}

void rp2040_uart_init(struct rp2040_uart *uart, struct rp2040_uart_block *block,
                      enum rp2040_irq irq, uint32_t core_hz, uint32_t baud) {
    uart->block = block;
    uart->irq = irq;
    uart->received = uart->sending = (struct cortexm_ring){0, 0};
    uart->lost_count = uart->damaged_count = 0;
    // 4.2.7.1: core_hz / (16 baud), in 64ths.
    const uint32_t divisor_64ths = (core_hz * 4U + baud / 2U) / baud;
    block->control = 0;
    block->divisor = divisor_64ths / 64U;
    block->divisor_64ths = divisor_64ths % 64U;
    block->line = RP2040_UART_LINE_FIFOS | RP2040_UART_LINE_8_BITS; // also takes the divisors over
    block->fifo_levels = 1U << 3; // interrupts: received 1/4 full, sending 1/8 full
    block->mask = LISTEN;
    block->control =
        RP2040_UART_CONTROL_ENABLE | RP2040_UART_CONTROL_SEND | RP2040_UART_CONTROL_RECEIVE;
    cortexm_irq_set_priority(irq, CORTEXM_PRIORITY_DEVICE);
    cortexm_irq_enable(irq);
}

/// 4.2.8, UARTDR: each byte comes with its errors; after an overrun it is good itself.
static void receive(struct rp2040_uart *uart) {
    const uint32_t data = uart->block->data;
    uart->lost_count = uart->lost_count + ((data & RP2040_UART_DATA_OVERRUN) != 0U);
    if ((data & RP2040_UART_DATA_DAMAGED) != 0U) {
        uart->damaged_count = uart->damaged_count + 1U;
    } else if (cortexm_ring_count(&uart->received) == RP2040_UART_RECEIVE_BYTES) {
        uart->lost_count = uart->lost_count + 1U;
    } else {
        uart->receive_bytes[uart->received.put % RP2040_UART_RECEIVE_BYTES] = (uint8_t)data;
        cortexm_ring_put(&uart->received);
    }
}

/// The interrupt for sending comes when the queue in the block runs low, not while it is low: so
/// the queue is filled to the brim as long as there is more.
void rp2040_uart_on_interrupt(struct rp2040_uart *uart) {
    struct rp2040_uart_block *block = uart->block;
    block->clear =
        RP2040_UART_INTERRUPT_RECEIVE | RP2040_UART_INTERRUPT_IDLE | RP2040_UART_INTERRUPT_SEND;
    while ((block->flags & RP2040_UART_FLAGS_RECEIVE_EMPTY) == 0U) {
        receive(uart);
    }
    while (cortexm_ring_count(&uart->sending) != 0U &&
           (block->flags & RP2040_UART_FLAGS_SEND_FULL) == 0U) {
        block->data = uart->send_bytes[uart->sending.taken % RP2040_UART_SEND_BYTES];
        cortexm_ring_take(&uart->sending);
    }
    block->mask = cortexm_ring_count(&uart->sending) != 0U
                      ? (uint32_t)LISTEN | RP2040_UART_INTERRUPT_SEND
                      : (uint32_t)LISTEN;
}

/// Serial ports USART1 to 3, UART4 and 5, USART6: asynchronous, 8 or 9 bits.
///
/// Source: RM0090, chapter 30. A byte takes as long as the baud rate that follows from the bus
/// clock says; the line outside (struct usart_line) has a speed of its own. Each side samples the
/// other's bits in their middle by its own clock, so a wrong baud rate gives wrong bytes and
/// framing errors, as on a wire. TXE, TC, RXNE, ORE, FE, IDLE and their interrupts. Left out: DMA,
/// LIN, smartcard, IrDA, synchronous mode, hardware flow control, multiprocessor mode, noise
/// detection (switching them on complains); of a byte that is longer than the receiver thinks, the
/// rest is not taken for another start bit. Shown: tests/mcu/usart.c.
#ifndef MCU_USART_H
#define MCU_USART_H

#include <stdbool.h>
#include <stdint.h>

struct soc;

enum { USART_COUNT = 6, USART_LINE_BYTES = 4096 };

/// The other end of the line.
struct usart_line {
    uint32_t baud;           ///< 0: nothing is connected
    unsigned tx_pin, rx_pin; ///< of the chip (GPIO_PIN): where the wires are
    /// A byte as the other end hears it; framed: its stop bit was right.
    void (*heard)(void *context, uint8_t byte, bool framed);
    void *context;
    // Bytes on their way to the chip.
    uint8_t waiting[USART_LINE_BYTES];
    uint32_t first, count;
};

struct usart {
    struct soc *soc;
    uint8_t index; ///< 0: USART1
    uint32_t sr, brr, cr1, cr2, cr3, gtpr;
    uint16_t received;    ///< DR, as read
    uint32_t errors_seen; ///< flags that a read of SR showed: a read of DR then clears them
    // Transmitter.
    uint16_t holding, shifting;
    bool holding_full, is_shifting;
    uint64_t shift_end_ns;
    // Receiver.
    bool receiving;
    uint64_t receive_end_ns, idle_ns; ///< idle_ns: when the line counts as idle; SOC_NEVER: it did
    struct usart_line line;
};

void usart_reset(struct usart *usart, struct soc *soc, unsigned index);
void usart_due(struct usart *usart);
uint32_t usart_read(void *model, uint32_t offset);
void usart_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// Connects the line; bytes that wait are dropped. Survives resets.
void usart_connect(struct usart *usart, const struct usart_line *line);

/// Sends bytes to the chip, one after the other at the line's speed. Returns how many were taken.
uint32_t usart_send(struct usart *usart, const uint8_t *bytes, uint32_t count);

/// Baud rate that the registers give; 0: none.
uint32_t usart_baud(const struct usart *usart);

#endif

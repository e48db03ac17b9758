/// A serial port on a USART: 8N1, both directions through rings that the interrupt handler works
/// on.
/// Shown: tests/mcu/hal/suites.c.
#ifndef STM32F4_STM32F4_USART_H
#define STM32F4_STM32F4_USART_H

#include "cortexm/cortexm_ring.h"
#include "hal/serial.h"
#include "stm32f4/stm32f4_registers.h"

/// Powers of two. At 115,200 baud 11.5 bytes arrive in a millisecond.
#define STM32F4_USART_RECEIVE_BYTES 512U
#define STM32F4_USART_SEND_BYTES    1024U

struct stm32f4_usart {
    struct hal_serial hal;
    struct stm32f4_usart_block *block;
    enum stm32f4_irq irq;
    struct cortexm_ring received, sending;
    volatile uint32_t lost_count, damaged_count;
    uint8_t receive_bytes[STM32F4_USART_RECEIVE_BYTES];
    uint8_t send_bytes[STM32F4_USART_SEND_BYTES];
};

/// bus_hz: of the bus that the block is on, as it is now. Pins are the caller's business.
void stm32f4_usart_init(struct stm32f4_usart *usart, struct stm32f4_usart_block *block,
                        enum stm32f4_irq irq, uint32_t bus_hz, uint32_t baud);

/// The handler of its interrupt.
void stm32f4_usart_on_interrupt(struct stm32f4_usart *usart);

#endif

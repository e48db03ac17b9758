#include "stm32f4/stm32f4_usart.h"

#include "stm32f4/stm32f4_clocks.h"

enum {
    CR1 = STM32F4_USART_CR1_UE | STM32F4_USART_CR1_TE | STM32F4_USART_CR1_RE |
          STM32F4_USART_CR1_RXNEIE
};

/// The handler is the only one that touches the block: the program tells it that there is work.
static enum hal_status serial_write(void *ctx, const uint8_t *data, size_t size_bytes,
                                    size_t *written_bytes) {
    struct stm32f4_usart *usart = ctx;
    size_t count = 0;
    while (count < size_bytes && cortexm_ring_count(&usart->sending) < STM32F4_USART_SEND_BYTES) {
        usart->send_bytes[usart->sending.put % STM32F4_USART_SEND_BYTES] = data[count++];
        cortexm_ring_put(&usart->sending);
    }
    *written_bytes = count;
    if (count == 0U) {
        return HAL_BUSY;
    }
    cortexm_irq_pend(usart->irq);
    return HAL_OK;
}

static enum hal_status serial_read(void *ctx, uint8_t *data, size_t capacity_bytes,
                                   size_t *read_bytes) {
    struct stm32f4_usart *usart = ctx;
    size_t count = 0;
    while (count < capacity_bytes && cortexm_ring_count(&usart->received) != 0U) {
        data[count++] = usart->receive_bytes[usart->received.taken % STM32F4_USART_RECEIVE_BYTES];
        cortexm_ring_take(&usart->received);
    }
    *read_bytes = count;
    return count != 0U ? HAL_OK : HAL_EMPTY;
}

static enum hal_status serial_state(void *ctx, struct hal_serial_state *state) {
    const struct stm32f4_usart *usart = ctx;
    *state = (struct hal_serial_state){usart->lost_count, usart->damaged_count};
    return HAL_OK;
}

static const struct hal_serial_ops stm32f4_usart_serial_ops = {serial_write, serial_read,
                                                               serial_state};

void stm32f4_usart_init(struct stm32f4_usart *usart, struct stm32f4_usart_block *block,
                        enum stm32f4_irq irq, uint32_t bus_hz, uint32_t baud) {
    (void)!hal_serial_bind(&usart->hal, &stm32f4_usart_serial_ops, usart);
    usart->block = block;
    usart->irq = irq;
    usart->received = usart->sending = (struct cortexm_ring){0, 0};
    usart->lost_count = usart->damaged_count = 0;
    stm32f4_clocks_enable(block);
    block->cr1 = 0;
    block->brr = (bus_hz + baud / 2U) / baud; // 30.3.4, sixteenfold oversampling
    block->cr1 = CR1;
    cortexm_irq_set_priority(irq, CORTEXM_PRIORITY_DEVICE);
    cortexm_irq_enable(irq);
}

/// 30.3.3: reading sr and then dr clears the flags. With an overrun, dr still has the byte before
/// the lost one.
static void receive(struct stm32f4_usart *usart, uint32_t sr) {
    const uint8_t byte = (uint8_t)usart->block->dr;
    usart->lost_count = usart->lost_count + ((sr & STM32F4_USART_SR_ORE) != 0U);
    if ((sr & (STM32F4_USART_SR_FE | STM32F4_USART_SR_NF)) != 0U) {
        usart->damaged_count = usart->damaged_count + 1U;
    } else if ((sr & STM32F4_USART_SR_RXNE) == 0U) {
        return;
    } else if (cortexm_ring_count(&usart->received) == STM32F4_USART_RECEIVE_BYTES) {
        usart->lost_count = usart->lost_count + 1U;
    } else {
        usart->receive_bytes[usart->received.put % STM32F4_USART_RECEIVE_BYTES] = byte;
        cortexm_ring_put(&usart->received);
    }
}

void stm32f4_usart_on_interrupt(struct stm32f4_usart *usart) {
    struct stm32f4_usart_block *block = usart->block;
    const uint32_t sr = block->sr;
    if ((sr & (STM32F4_USART_SR_RXNE | STM32F4_USART_SR_ORE)) != 0U) {
        receive(usart, sr);
    }
    while (cortexm_ring_count(&usart->sending) != 0U && (block->sr & STM32F4_USART_SR_TXE) != 0U) {
        block->dr = usart->send_bytes[usart->sending.taken % STM32F4_USART_SEND_BYTES];
        cortexm_ring_take(&usart->sending);
    }
    block->cr1 = cortexm_ring_count(&usart->sending) != 0U ? (uint32_t)CR1 | STM32F4_USART_CR1_TXEIE
                                                           : (uint32_t)CR1;
}

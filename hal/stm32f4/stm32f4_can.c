#include "stm32f4/stm32f4_can.h"

#include "stm32f4/stm32f4_clocks.h"

/// 32.7.7: 42 MHz / 3 = 14 time quanta a bit, sampled after 11 of them; may jump by 3.
#define BIT_TIMING (2U << 24 | 2U << 20 | 9U << 16 | 2U)

#define STALE_US 20000U

/// What takes a few cycles of the block's clock.
#define SHORT_READS 1000U
/// Leaving sleep or joining waits for 11 recessive bits or the end of a frame at most: 150 us.
#define ENTER_READS 20000U

enum {
    MCR = STM32F4_CAN_MCR_TXFP | STM32F4_CAN_MCR_RFLM | 1 << 16,
    IER = STM32F4_CAN_IER_TMEIE | STM32F4_CAN_IER_FMPIE0 | STM32F4_CAN_IER_FOVIE0 |
          STM32F4_CAN_IER_BOFIE | STM32F4_CAN_IER_ERRIE,
    MAILBOXES = 3
};

static struct stm32f4_can_block *const block = STM32F4_CAN1;

// ------------------------------------------------------------------------------------- id words

/// 32.9.3, 32.7.4: an id as it lies in a mailbox or in a filter.
static uint32_t id_word(uint32_t id, unsigned flags) {
    const bool extended = (flags & CAN_FRAME_EXTENDED) != 0U;
    return (extended ? id << STM32F4_CAN_IR_EXTENDED_SHIFT | STM32F4_CAN_IR_IDE
                     : id << STM32F4_CAN_IR_STANDARD_SHIFT) |
           ((flags & CAN_FRAME_REMOTE) != 0U ? (uint32_t)STM32F4_CAN_IR_RTR : 0U);
}

static void load(struct stm32f4_can_mailbox *mailbox, const struct can_frame *frame) {
    uint32_t word[2] = {0, 0};
    for (unsigned i = 0; i < CAN_FRAME_DATA_BYTES; i++) {
        word[i / 4U] |= (uint32_t)frame->data[i] << i % 4U * 8U;
    }
    mailbox->dtr = frame->length;
    mailbox->dlr = word[0];
    mailbox->dhr = word[1];
    mailbox->ir = id_word(frame->id, frame->flags) | STM32F4_CAN_IR_TXRQ;
}

static void unload(const struct stm32f4_can_mailbox *mailbox, struct can_frame *frame) {
    const uint32_t ir = mailbox->ir, length = mailbox->dtr & 15U;
    const bool extended = (ir & STM32F4_CAN_IR_IDE) != 0U;
    frame->id = ir >> (extended ? STM32F4_CAN_IR_EXTENDED_SHIFT : STM32F4_CAN_IR_STANDARD_SHIFT);
    frame->flags = (uint8_t)((extended ? CAN_FRAME_EXTENDED : 0) |
                             ((ir & STM32F4_CAN_IR_RTR) != 0U ? CAN_FRAME_REMOTE : 0));
    // A length code above 8 means 8 (ISO 11898-1).
    frame->length = (uint8_t)(length < CAN_FRAME_DATA_BYTES ? length : CAN_FRAME_DATA_BYTES);
    const uint32_t word[2] = {mailbox->dlr, mailbox->dhr};
    for (unsigned i = 0; i < CAN_FRAME_DATA_BYTES; i++) {
        frame->data[i] = (uint8_t)(word[i / 4U] >> i % 4U * 8U);
    }
}

// --------------------------------------------------------------------------- interrupt handlers

static uint32_t busy_mailboxes(uint32_t tsr) {
    uint32_t busy = 0;
    for (unsigned i = 0; i < MAILBOXES; i++) {
        busy += (tsr & (uint32_t)STM32F4_CAN_TSR_TME0 << i) == 0U;
    }
    return busy;
}

/// All that happens to mailboxes happens here; the program pends the interrupt when it wants
/// something. Mailboxes are sent in the order of their loading (TXFP).
void stm32f4_can_on_transmit(struct stm32f4_can *can) {
    block->msr = STM32F4_CAN_MSR_ERRI;
    const uint32_t tsr = block->tsr;
    if ((tsr & STM32F4_CAN_TSR_TXOK) != 0U) {
        can->sent_us = cortexm_clock_now_us(can->clock);
    }
    block->tsr = tsr & STM32F4_CAN_TSR_RQCP; // clears what went with it, too
    if (can->drop || (block->esr & STM32F4_CAN_ESR_BOFF) != 0U) {
        can->drop = false;
        can->dropped_count =
            can->dropped_count + cortexm_ring_count(&can->sending) + busy_mailboxes(tsr);
        cortexm_ring_clear(&can->sending);
        block->tsr = STM32F4_CAN_TSR_ABRQ;
        return;
    }
    for (unsigned i = 0; i < MAILBOXES && cortexm_ring_count(&can->sending) != 0U; i++) {
        if ((block->tsr & (uint32_t)STM32F4_CAN_TSR_TME0 << i) != 0U) {
            load(&block->transmit[i],
                 &can->send_frame[can->sending.taken % STM32F4_CAN_SEND_FRAMES]);
            cortexm_ring_take(&can->sending);
        }
    }
}

static bool is_wanted(const struct stm32f4_can *can, const struct can_frame *frame) {
    for (uint32_t i = 0; i < can->filter_count; i++) {
        if (hal_can_filter_passes(&can->filters[i], frame)) {
            return true;
        }
    }
    return false;
}

static void take_in(struct stm32f4_can *can, const struct stm32f4_can_mailbox *mailbox) {
    const uint32_t at = can->received.put % STM32F4_CAN_RECEIVE_FRAMES;
    struct can_frame frame;
    unload(mailbox, &frame);
    if (!is_wanted(can, &frame)) {
        return;
    }
    if (cortexm_ring_count(&can->received) == STM32F4_CAN_RECEIVE_FRAMES) {
        can->lost_count = can->lost_count + 1U;
        return;
    }
    can->receive_frame[at] = frame;
    can->received_us[at] = cortexm_clock_now_us(can->clock);
    cortexm_ring_put(&can->received);
}

/// At most the three frames that the FIFO holds; if more have come, the interrupt is still there.
void stm32f4_can_on_receive(struct stm32f4_can *can) {
    volatile uint32_t *rfr = &block->rfr[0];
    if ((*rfr & STM32F4_CAN_RFR_FOVR) != 0U) {
        *rfr = STM32F4_CAN_RFR_FOVR;
        can->lost_count = can->lost_count + 1U;
    }
    for (unsigned i = 0; i < 3U; i++) {
        const uint32_t fifo = *rfr;
        if ((fifo & STM32F4_CAN_RFR_FMP) == 0U || (fifo & STM32F4_CAN_RFR_RFOM) != 0U) {
            return;
        }
        take_in(can, &block->receive[0]);
        *rfr = STM32F4_CAN_RFR_RFOM;
    }
}

// -------------------------------------------------------------------------------- the interface

/// Away from the bus? Also takes the second step of a restart: back from initialisation, from where
/// the block counts the quiet bits of the recovery by itself (32.7.6).
static bool is_off(struct stm32f4_can *can) {
    if (!can->started) {
        return true;
    }
    if (can->restarting && (block->msr & STM32F4_CAN_MSR_INAK) != 0U) {
        block->mcr = MCR;
    }
    const bool off = (block->msr & STM32F4_CAN_MSR_INAK) != 0U ||
                     (block->mcr & STM32F4_CAN_MCR_INRQ) != 0U ||
                     (block->esr & STM32F4_CAN_ESR_BOFF) != 0U;
    can->restarting = can->restarting && off;
    return off;
}

static enum hal_status can_send(void *ctx, const struct can_frame *frame) {
    struct stm32f4_can *can = ctx;
    if (is_off(can)) {
        return HAL_ERROR_DOWN;
    }
    const uint32_t now_us = cortexm_clock_now_us(can->clock);
    if (cortexm_ring_count(&can->sending) == 0U && busy_mailboxes(block->tsr) == 0U) {
        can->sent_us = now_us;
    } else if (hal_clock_span_us(can->sent_us, now_us) > STALE_US) {
        can->sent_us = now_us;
        can->drop = true;
        cortexm_irq_pend(STM32F4_IRQ_CAN1_TX);
    }
    if (cortexm_ring_count(&can->sending) == STM32F4_CAN_SEND_FRAMES) {
        return HAL_BUSY;
    }
    can->send_frame[can->sending.put % STM32F4_CAN_SEND_FRAMES] = *frame;
    cortexm_ring_put(&can->sending);
    cortexm_irq_pend(STM32F4_IRQ_CAN1_TX);
    return HAL_OK;
}

static enum hal_status can_receive(void *ctx, struct can_frame *frame, uint32_t *received_us) {
    struct stm32f4_can *can = ctx;
    if (cortexm_ring_count(&can->received) == 0U) {
        return HAL_EMPTY;
    }
    const uint32_t at = can->received.taken % STM32F4_CAN_RECEIVE_FRAMES;
    *frame = can->receive_frame[at];
    *received_us = can->received_us[at];
    cortexm_ring_take(&can->received);
    return HAL_OK;
}

static enum hal_status can_state(void *ctx, struct hal_can_state *state) {
    struct stm32f4_can *can = ctx;
    const bool off = is_off(can);
    const uint32_t esr = can->started ? block->esr : 0U;
    const bool passive = (esr & STM32F4_CAN_ESR_EPVF) != 0U;
    *state = (struct hal_can_state){
        .health = off       ? HAL_CAN_OFF
                  : passive ? HAL_CAN_PASSIVE
                            : HAL_CAN_ACTIVE,
        .transmit_error_count = off ? 256U : (uint8_t)(esr >> STM32F4_CAN_ESR_TEC_SHIFT),
        .receive_error_count = (uint8_t)(esr >> STM32F4_CAN_ESR_REC_SHIFT),
        .lost_count = can->lost_count};
    return HAL_OK;
}

/// 32.7.4: banks of 32 bits with a mask, all into FIFO 0. While they change, nothing is received.
static void write_filters(const struct stm32f4_can *can) {
    const uint32_t all = (1U << STM32F4_CAN_FILTERS) - 1U;
    block->fmr |= STM32F4_CAN_FMR_FINIT;
    block->fa1r &= ~all;
    block->fm1r &= ~all;
    block->fs1r |= all;
    block->ffa1r &= ~all;
    for (uint32_t i = 0; i < can->filter_count; i++) {
        const struct hal_can_filter *filter = &can->filters[i];
        const bool one_kind = (filter->flags_mask & CAN_FRAME_EXTENDED) != 0U;
        // The mask has the id's bits in the same places; that of the kind is then always compared.
        const unsigned mask_flags =
            (filter->flags & CAN_FRAME_EXTENDED) | (filter->flags_mask & CAN_FRAME_REMOTE);
        block->filter[i].id = id_word(filter->id, filter->flags);
        block->filter[i].mask =
            one_kind ? id_word(filter->id_mask, mask_flags) | STM32F4_CAN_IR_IDE : 0U;
    }
    block->fa1r |= (1U << can->filter_count) - 1U;
    block->fmr &= ~(uint32_t)STM32F4_CAN_FMR_FINIT;
}

static enum hal_status can_set_filters(void *ctx, const struct hal_can_filter *filters,
                                       uint32_t count) {
    struct stm32f4_can *can = ctx;
    if (can->started) { // the handler looks at the table
        block->ier = IER & ~(uint32_t)(STM32F4_CAN_IER_FMPIE0 | STM32F4_CAN_IER_FOVIE0);
    }
    for (uint32_t i = 0; i < count; i++) {
        can->filters[i] = filters[i];
    }
    can->filter_count = count;
    if (can->started) {
        write_filters(can);
        block->ier = IER;
    }
    return HAL_OK;
}

/// 32.7.6: from bus-off by way of initialisation. The block enters that at once, as it takes no
/// part in a frame; should it not, is_off leads on from there.
static enum hal_status can_restart(void *ctx) {
    struct stm32f4_can *can = ctx;
    if (can->started && !can->restarting && (block->esr & STM32F4_CAN_ESR_BOFF) != 0U) {
        can->restarting = true;
        block->mcr = MCR | STM32F4_CAN_MCR_INRQ;
        (void)cortexm_wait_bits(&block->msr, STM32F4_CAN_MSR_INAK, STM32F4_CAN_MSR_INAK,
                                SHORT_READS);
        (void)is_off(can);
    }
    return HAL_OK;
}

static const struct hal_can_ops stm32f4_can_ops = {can_send, can_receive, can_state,
                                                   can_set_filters, can_restart};

void stm32f4_can_init(struct stm32f4_can *can, const struct cortexm_clock *clock) {
    (void)!hal_can_bind(&can->hal, &stm32f4_can_ops, can);
    can->clock = clock;
    can->started = can->restarting = can->drop = false;
    can->received = can->sending = (struct cortexm_ring){0, 0};
    can->lost_count = can->dropped_count = 0;
    can->filter_count = 1; // of zeros: everything passes
    can->filters[0] = (struct hal_can_filter){0};
}

enum hal_status stm32f4_can_start(struct stm32f4_can *can) {
    stm32f4_clocks_enable(block);
    block->mcr = MCR | STM32F4_CAN_MCR_INRQ; // and no longer asleep
    if (!cortexm_wait_bits(&block->msr, STM32F4_CAN_MSR_INAK | STM32F4_CAN_MSR_SLAK,
                           STM32F4_CAN_MSR_INAK, ENTER_READS)) {
        return HAL_ERROR_IO;
    }
    block->btr = BIT_TIMING;
    write_filters(can);
    block->ier = IER;
    can->started = true;
    block->mcr = MCR;
    static const enum stm32f4_irq irqs[] = {STM32F4_IRQ_CAN1_TX, STM32F4_IRQ_CAN1_RX0,
                                            STM32F4_IRQ_CAN1_SCE};
    for (unsigned i = 0; i < sizeof irqs / sizeof irqs[0]; i++) {
        cortexm_irq_set_priority(irqs[i], CORTEXM_PRIORITY_DEVICE);
        cortexm_irq_enable(irqs[i]);
    }
    return HAL_OK;
}

#include "mcu/usart.h"

#include "mcu/soc.h"

#define SR_PE   (UINT32_C(1) << 0)
#define SR_FE   (UINT32_C(1) << 1)
#define SR_NF   (UINT32_C(1) << 2)
#define SR_ORE  (UINT32_C(1) << 3)
#define SR_IDLE (UINT32_C(1) << 4)
#define SR_RXNE (UINT32_C(1) << 5)
#define SR_TC   (UINT32_C(1) << 6)
#define SR_TXE  (UINT32_C(1) << 7)
#define SR_LBD  (UINT32_C(1) << 8)
#define SR_CTS  (UINT32_C(1) << 9)
/// Cleared by a read of SR and then of DR.
#define SR_BY_READING (SR_PE | SR_FE | SR_NF | SR_ORE | SR_IDLE)
/// Cleared by writing 0.
#define SR_BY_WRITING (SR_RXNE | SR_TC | SR_LBD | SR_CTS)

#define CR1_RWU    (UINT32_C(1) << 1)
#define CR1_RE     (UINT32_C(1) << 2)
#define CR1_TE     (UINT32_C(1) << 3)
#define CR1_IDLEIE (UINT32_C(1) << 4)
#define CR1_RXNEIE (UINT32_C(1) << 5)
#define CR1_TCIE   (UINT32_C(1) << 6)
#define CR1_TXEIE  (UINT32_C(1) << 7)
#define CR1_PEIE   (UINT32_C(1) << 8)
#define CR1_PCE    (UINT32_C(1) << 10)
#define CR1_M      (UINT32_C(1) << 12)
#define CR1_UE     (UINT32_C(1) << 13)
#define CR1_OVER8  (UINT32_C(1) << 15)
#define CR1_BITS   0xBFFFU
#define CR2_BITS   0x7F6FU
#define CR2_LIN    0x4000U
#define CR2_CLOCK  0x0800U
#define CR3_EIE    (UINT32_C(1) << 0)
#define CR3_BITS   0xFFFU
#define CR3_OTHERS 0x07FEU // everything but EIE and ONEBIT

// ---------------------------------------------------------------- bits on the wire

uint32_t usart_baud(const struct usart *usart) {
    const bool fast_bus = usart->index == 0U || usart->index == 5U; // USART1, USART6: APB2
    const uint32_t clock = rcc_pclk_hz(&usart->soc->rcc, fast_bus ? RCC_APB2 : RCC_APB1);
    const uint32_t whole = usart->brr >> 4;
    if ((usart->cr1 & CR1_OVER8) != 0U) {
        const uint32_t eighths = whole * 8U + (usart->brr & 7U);
        return eighths != 0U ? clock / eighths : 0U;
    }
    return usart->brr >= 16U ? clock / usart->brr : 0U;
}

static unsigned data_bits(const struct usart *usart) {
    return (usart->cr1 & CR1_M) != 0U ? 9U : 8U;
}

static uint64_t frame_ns(uint32_t baud, unsigned bits) {
    return (UINT64_C(1000000000) * (bits + 2U) + baud / 2U) / baud;
}

/// What a receiver makes of a byte when its clock differs from the sender's: it samples in the
/// middle of what it takes for the bits.
static uint16_t resample(uint16_t word, unsigned bits, uint32_t sender_baud, uint32_t receiver_baud,
                         unsigned receiver_bits, bool *framed) {
    // The wire, bit by bit: start, data with the least significant first, then high.
    const uint32_t wire = ~UINT32_C(0) << (bits + 1U) | ((uint32_t)word & ((1U << bits) - 1U)) << 1;
    uint16_t heard = 0;
    for (unsigned i = 1; i <= receiver_bits + 1U; i++) {
        const uint64_t at = (2U * i + 1U) * (uint64_t)sender_baud / (2U * (uint64_t)receiver_baud);
        const bool high = at >= 32U || (wire >> at & 1U) != 0U;
        if (i == receiver_bits + 1U) {
            *framed = high;
        } else if (high) {
            heard = (uint16_t)(heard | 1U << (i - 1U));
        }
    }
    return heard;
}

/// The part of the chip is on, and its pin leads to the line.
static bool is_wired(const struct usart *usart, enum gpio_signal signal, unsigned pin) {
    return usart->line.baud != 0U && gpio_is_connected(usart->soc, pin, signal, usart->index);
}

// ---------------------------------------------------------------- interrupts and events

static void settle(struct usart *usart) {
    static const uint8_t irq_of[USART_COUNT] = {37, 38, 39, 52, 53, 71};
    const uint32_t sr = usart->sr, cr1 = usart->cr1;
    const bool wanted = ((cr1 & CR1_TXEIE) != 0U && (sr & SR_TXE) != 0U) ||
                        ((cr1 & CR1_TCIE) != 0U && (sr & SR_TC) != 0U) ||
                        ((cr1 & CR1_RXNEIE) != 0U && (sr & (SR_RXNE | SR_ORE)) != 0U) ||
                        ((cr1 & CR1_IDLEIE) != 0U && (sr & SR_IDLE) != 0U) ||
                        ((cr1 & CR1_PEIE) != 0U && (sr & SR_PE) != 0U);
    nvic_set_line(&usart->soc->nvic, irq_of[usart->index], wanted && (cr1 & CR1_UE) != 0U);
    uint64_t next = usart->is_shifting ? usart->shift_end_ns : SOC_NEVER;
    if (usart->receiving && usart->receive_end_ns < next) {
        next = usart->receive_end_ns;
    }
    if (!usart->receiving && usart->idle_ns < next) {
        next = usart->idle_ns;
    }
    soc_schedule_ns(usart->soc, (enum soc_part)(SOC_USART1 + usart->index), next);
}

// ---------------------------------------------------------------- transmitter

static void begin_shift(struct usart *usart, uint64_t now_ns) {
    const uint32_t baud = usart_baud(usart);
    if (!usart->holding_full || usart->is_shifting || baud == 0U ||
        (usart->cr1 & (CR1_UE | CR1_TE)) != (CR1_UE | CR1_TE)) {
        return;
    }
    usart->shifting = usart->holding;
    usart->holding_full = false;
    usart->is_shifting = true;
    usart->shift_end_ns = now_ns + frame_ns(baud, data_bits(usart));
    usart->sr |= SR_TXE;
}

static void end_shift(struct usart *usart) {
    const struct usart_line *line = &usart->line;
    const uint64_t end_ns = usart->shift_end_ns;
    usart->is_shifting = false;
    if (is_wired(usart, GPIO_SIGNAL_USART_TX, line->tx_pin) && line->heard != NULL) {
        bool framed;
        const uint16_t byte =
            resample(usart->shifting, data_bits(usart), usart_baud(usart), line->baud, 8, &framed);
        line->heard(line->context, (uint8_t)byte, framed);
    }
    begin_shift(usart, end_ns);
    if (!usart->is_shifting) {
        usart->sr |= SR_TC;
    }
}

// ---------------------------------------------------------------- receiver

static bool is_listening(const struct usart *usart) {
    return (usart->cr1 & (CR1_UE | CR1_RE)) == (CR1_UE | CR1_RE) && usart_baud(usart) != 0U;
}

static void begin_receive(struct usart *usart, uint64_t now_ns) {
    if (!usart->receiving && usart->line.count != 0U) {
        usart->receiving = true;
        usart->receive_end_ns = now_ns + frame_ns(usart->line.baud, 8);
    }
}

static void take_byte(struct usart *usart, uint16_t word, bool framed) {
    if ((usart->sr & SR_RXNE) != 0U) {
        usart->sr |= SR_ORE; // the byte is lost, what was received before stays
        return;
    }
    usart->received = word;
    usart->sr |= SR_RXNE | (framed ? 0U : SR_FE);
}

static void end_receive(struct usart *usart) {
    struct usart_line *line = &usart->line;
    const uint64_t end_ns = usart->receive_end_ns;
    const uint8_t byte = line->waiting[line->first];
    line->first = (line->first + 1U) % USART_LINE_BYTES;
    line->count--;
    usart->receiving = false;
    if (is_listening(usart) && is_wired(usart, GPIO_SIGNAL_USART_RX, line->rx_pin)) {
        bool framed;
        const uint32_t baud = usart_baud(usart);
        const uint16_t word = resample(byte, 8, line->baud, baud, data_bits(usart), &framed);
        take_byte(usart, word, framed);
        usart->idle_ns = end_ns + frame_ns(baud, data_bits(usart));
    }
    begin_receive(usart, end_ns);
}

void usart_due(struct usart *usart) {
    const uint64_t now = soc_now_ns(usart->soc);
    while (usart->is_shifting && usart->shift_end_ns <= now) {
        end_shift(usart);
    }
    while (usart->receiving && usart->receive_end_ns <= now) {
        end_receive(usart);
    }
    if (!usart->receiving && usart->idle_ns <= now) {
        usart->idle_ns = SOC_NEVER; // not again before the next byte
        usart->sr |= SR_IDLE;
    }
    settle(usart);
}

uint32_t usart_send(struct usart *usart, const uint8_t *bytes, uint32_t count) {
    struct usart_line *line = &usart->line;
    uint32_t taken = 0;
    while (line->baud != 0U && taken < count && line->count < USART_LINE_BYTES) {
        line->waiting[(line->first + line->count++) % USART_LINE_BYTES] = bytes[taken++];
    }
    begin_receive(usart, soc_now_ns(usart->soc));
    settle(usart);
    return taken;
}

void usart_connect(struct usart *usart, const struct usart_line *line) {
    usart->line = *line;
    usart->line.first = usart->line.count = 0;
    usart->receiving = false;
    settle(usart);
}

void usart_reset(struct usart *usart, struct soc *soc, unsigned index) {
    usart->soc = soc;
    usart->index = (uint8_t)index;
    usart->sr = SR_TXE | SR_TC;
    usart->brr = usart->cr1 = usart->cr2 = usart->cr3 = usart->gtpr = 0;
    usart->received = 0;
    usart->errors_seen = 0;
    usart->holding_full = usart->is_shifting = false;
    usart->idle_ns = SOC_NEVER;
    settle(usart); // what comes down the line goes on coming
}

// ---------------------------------------------------------------- registers

static uint32_t read_data(struct usart *usart) {
    usart->sr &= ~(SR_RXNE | usart->errors_seen);
    usart->errors_seen = 0;
    settle(usart);
    return usart->received;
}

uint32_t usart_read(void *model, uint32_t offset) {
    struct usart *usart = model;
    switch (offset) {
    case 0x00:
        usart->errors_seen = usart->sr & SR_BY_READING;
        usart->errors_seen |= usart->sr & SR_TC; // a write of DR clears it then
        return usart->sr;
    case 0x04:
        usart->errors_seen &= SR_BY_READING;
        return read_data(usart);
    case 0x08:
        return usart->brr;
    case 0x0C:
        return usart->cr1;
    case 0x10:
        return usart->cr2;
    case 0x14:
        return usart->cr3;
    case 0x18:
        return usart->gtpr;
    default:
        return 0;
    }
}

static void write_data(struct usart *usart, uint32_t value) {
    if (usart->holding_full) {
        soc_complain(usart->soc, "USART%u: DR is written while TXE is 0: a byte is lost",
                     usart->index + 1U);
    }
    usart->holding = value & 0x1FFU;
    usart->holding_full = true;
    usart->sr &= ~(SR_TXE | (usart->errors_seen & SR_TC));
    usart->errors_seen &= ~SR_TC;
    begin_shift(usart, soc_now_ns(usart->soc));
}

static void complain_of_modes(struct usart *usart) {
    if ((usart->cr1 & (CR1_PCE | CR1_RWU)) != 0U || (usart->cr2 & (CR2_LIN | CR2_CLOCK)) != 0U ||
        (usart->cr3 & CR3_OTHERS) != 0U) {
        soc_complain(usart->soc, "USART%u: parity, DMA and the special modes have no model",
                     usart->index + 1U);
    }
    if ((usart->cr1 & CR1_OVER8) != 0U && (usart->brr & 8U) != 0U) {
        soc_complain(usart->soc, "USART%u: bit 3 of BRR must be 0 with OVER8", usart->index + 1U);
    }
}

void usart_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct usart *usart = model;
    (void)lanes;
    switch (offset) {
    case 0x00:
        usart->sr &= value | ~SR_BY_WRITING;
        break;
    case 0x04:
        write_data(usart, value);
        break;
    case 0x08:
        usart->brr = value & 0xFFFFU;
        break;
    case 0x0C:
        usart->cr1 = value & CR1_BITS;
        begin_shift(usart, soc_now_ns(usart->soc));
        break;
    case 0x10:
        usart->cr2 = value & CR2_BITS;
        break;
    case 0x14:
        usart->cr3 = value & CR3_BITS;
        break;
    case 0x18:
        usart->gtpr = value & 0xFFFFU;
        break;
    default:
        break;
    }
    complain_of_modes(usart);
    settle(usart);
}

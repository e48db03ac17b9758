#include "mcu/bxcan.h"

#include "mcu/soc.h"

#include <string.h>

#define MCR_INRQ           (UINT32_C(1) << 0)
#define MCR_SLEEP          (UINT32_C(1) << 1)
#define MCR_ABOM           (UINT32_C(1) << 6)
#define MCR_TTCM           (UINT32_C(1) << 7)
#define MCR_RESET          (UINT32_C(1) << 15)
#define MCR_AT_RESET       0x00010002U
#define MCR_BITS           0x000100FFU
#define MSR_INAK           (UINT32_C(1) << 0)
#define MSR_SLAK           (UINT32_C(1) << 1)
#define MSR_ERRI           (UINT32_C(1) << 2)
#define MSR_WKUI           (UINT32_C(1) << 3)
#define MSR_SLAKI          (UINT32_C(1) << 4)
#define MSR_TXM            (UINT32_C(1) << 8)
#define MSR_LINE           0xC00U // SAMP and RX: recessive
#define IER_BITS           0x00038F7FU
#define IER_EWGIE          (UINT32_C(1) << 8)
#define IER_EPVIE          (UINT32_C(1) << 9)
#define IER_BOFIE          (UINT32_C(1) << 10)
#define IER_LECIE          (UINT32_C(1) << 11)
#define IER_ERRIE          (UINT32_C(1) << 15)
#define IER_WKUIE          (UINT32_C(1) << 16)
#define IER_SLKIE          (UINT32_C(1) << 17)
#define BTR_AT_RESET       0x01230000U
#define BTR_BITS           0xC37F03FFU
#define BTR_LBKM           (UINT32_C(1) << 30)
#define BTR_SILM           (UINT32_C(1) << 31)
#define TSR_ALL_RQCP       0x00010101U
#define ESR_EWGF           1U
#define ESR_EPVF           2U
#define ESR_BOFF           4U
#define RECOVERY_STRETCHES 128U

static bool in_init(const struct bxcan *can) {
    return (can->msr & MSR_INAK) != 0U;
}

static bool in_sleep(const struct bxcan *can) {
    return (can->msr & MSR_SLAK) != 0U;
}

bool bxcan_listens(const struct bxcan *can) {
    return !in_init(can) && !in_sleep(can) && !can->synchronising && !can->bus_off &&
           (can->btr & BTR_LBKM) == 0U;
}

bool bxcan_takes_part(const struct bxcan *can) {
    return bxcan_listens(can) && (can->btr & BTR_SILM) == 0U;
}

uint64_t bxcan_bit_ps(const struct bxcan *can) {
    const uint64_t quanta = 3U + (can->btr >> 16 & 15U) + (can->btr >> 20 & 7U);
    const uint64_t prescaler = (can->btr & 0x3FFU) + 1U;
    return quanta * prescaler * UINT64_C(1000000000000) / rcc_pclk_hz(&can->soc->rcc, RCC_APB1);
}

static uint64_t bit_ns(const struct bxcan *can) {
    return bxcan_bit_ps(can) / 1000U + 1U;
}

static enum soc_part part_of(const struct bxcan *can) {
    return can->index == 0U ? SOC_CAN1 : SOC_CAN2;
}

// ---------------------------------------------------------------- flags and interrupts

static uint32_t error_flags(const struct bxcan *can) {
    return (can->tec >= 96U || can->rec >= 96U || can->bus_off ? ESR_EWGF : 0U) |
           (can->tec > 127U || can->rec > 127U || can->bus_off ? ESR_EPVF : 0U) |
           (can->bus_off ? ESR_BOFF : 0U);
}

static uint32_t read_esr(const struct bxcan *can) {
    const uint32_t tec = can->tec < 255U ? can->tec : 255U;
    return error_flags(can) | can->lec << 4 | tec << 16 | can->rec << 24;
}

static void update_interrupts(const struct bxcan *can) {
    struct nvic *nvic = &can->soc->nvic;
    const unsigned first = can->index == 0U ? 19U : 63U;
    const uint32_t ier = can->ier, msr = can->msr;
    nvic_set_line(nvic, first, (ier & 1U) != 0U && (can->tsr & TSR_ALL_RQCP) != 0U);
    for (unsigned i = 0; i < 2U; i++) {
        const struct bxcan_fifo *fifo = &can->fifo[i];
        const uint32_t enables = ier >> (1U + 3U * i);
        nvic_set_line(nvic, first + 1U + i,
                      ((enables & 1U) != 0U && fifo->count != 0U) ||
                          ((enables & 2U) != 0U && fifo->full) ||
                          ((enables & 4U) != 0U && fifo->overrun));
    }
    nvic_set_line(nvic, first + 3U,
                  ((ier & IER_ERRIE) != 0U && (msr & MSR_ERRI) != 0U) ||
                      ((ier & IER_WKUIE) != 0U && (msr & MSR_WKUI) != 0U) ||
                      ((ier & IER_SLKIE) != 0U && (msr & MSR_SLAKI) != 0U));
}

/// A flag of ESR that rose, or an error code, with its interrupt enabled sets ERRI.
static void notice_errors(struct bxcan *can) {
    const uint32_t flags = error_flags(can), rose = flags & ~can->seen_flags;
    can->seen_flags = flags;
    const bool coded = can->lec != BXCAN_LEC_NONE && can->lec != 7U && can->lec_is_new;
    can->lec_is_new = false;
    if (((rose & ESR_EWGF) != 0U && (can->ier & IER_EWGIE) != 0U) ||
        ((rose & ESR_EPVF) != 0U && (can->ier & IER_EPVIE) != 0U) ||
        ((rose & ESR_BOFF) != 0U && (can->ier & IER_BOFIE) != 0U) ||
        (coded && (can->ier & IER_LECIE) != 0U)) {
        can->msr |= MSR_ERRI;
    }
}

// ---------------------------------------------------------------- modes

static uint64_t quiet_stretches(const struct bxcan *can) {
    if (can->port != NULL) {
        return can->port->quiet_stretches(can->port->context);
    }
    return soc_now_ns(can->soc) / (11U * bit_ns(can));
}

/// Starts waiting for recessive bits.
static void begin_waiting(struct bxcan *can) {
    can->quiet_from = quiet_stretches(can);
}

static bool is_busy(const struct bxcan *can) {
    return can->on_wire >= 0 ||
           (bxcan_listens(can) && can->port != NULL && can->port->busy(can->port->context));
}

/// Which of MSR's modes MCR asks for: MSR_SLAK, MSR_INAK or 0 (normal).
static uint32_t wanted_mode(const struct bxcan *can) {
    if ((can->mcr & MCR_SLEEP) != 0U) {
        return MSR_SLAK;
    }
    return (can->mcr & MCR_INRQ) != 0U ? MSR_INAK : 0U;
}

static void enter_mode(struct bxcan *can, uint32_t mode) {
    can->msr = (can->msr & ~(MSR_INAK | MSR_SLAK)) | mode;
    can->msr |= mode == MSR_SLAK ? MSR_SLAKI : 0U;
    can->synchronising = false;
    if (mode == 0U && can->bus_off && !can->recovering) {
        can->recovering = true; // software has asked for it by leaving initialisation
        begin_waiting(can);
    } else if (mode != 0U) {
        can->recovering = false;
    }
}

/// Goes where MCR wants it, as far as the bus lets it.
static void change_mode(struct bxcan *can) {
    const uint32_t mode = can->msr & (MSR_INAK | MSR_SLAK), wanted = wanted_mode(can);
    const uint64_t now = soc_now_ns(can->soc);
    if (wanted == mode) {
        can->mode_change_ns = SOC_NEVER;
        can->synchronising = false;
        return;
    }
    if (wanted == 0U) { // out of sleep or initialisation: 11 recessive bits first
        if (!can->synchronising) {
            can->synchronising = true;
            begin_waiting(can);
        } else if (quiet_stretches(can) - can->quiet_from >= 1U) {
            enter_mode(can, 0U);
        }
        return;
    }
    can->synchronising = false;
    if (is_busy(can) || (wanted == MSR_INAK && (can->soc->options.stuck & SOC_STUCK_CAN) != 0U)) {
        can->mode_change_ns = SOC_NEVER; // looked at again when the frame has ended
    } else if (can->mode_change_ns == SOC_NEVER) {
        can->mode_change_ns = now + bit_ns(can);
    } else if (can->mode_change_ns <= now) {
        can->mode_change_ns = SOC_NEVER;
        enter_mode(can, wanted);
    }
}

static void recover(struct bxcan *can) {
    if (can->bus_off && !can->recovering && (can->mcr & MCR_ABOM) != 0U && !in_init(can) &&
        !in_sleep(can)) {
        can->recovering = true;
        begin_waiting(can);
    }
    if (can->recovering && quiet_stretches(can) - can->quiet_from >= RECOVERY_STRETCHES) {
        can->recovering = can->bus_off = false;
        can->tec = can->rec = 0;
    }
}

/// When to look again.
static void schedule(struct bxcan *can) {
    uint64_t next = can->mode_change_ns < can->loop_end_ns ? can->mode_change_ns : can->loop_end_ns;
    if (can->synchronising || can->recovering) {
        const uint64_t seen = quiet_stretches(can) - can->quiet_from;
        const uint64_t wanted = can->synchronising ? 1U : RECOVERY_STRETCHES;
        const uint64_t left = seen < wanted ? wanted - seen : 1U;
        const uint64_t at = soc_now_ns(can->soc) + left * 11U * bit_ns(can);
        next = at < next ? at : next;
    }
    soc_schedule_ns(can->soc, part_of(can), next);
}

/// In loop-back mode a frame comes back after the time that it would take on the bus.
static void loop_back(struct bxcan *can) {
    struct can_frame frame;
    if ((can->btr & BTR_LBKM) == 0U || in_init(can) || in_sleep(can) || can->synchronising) {
        return;
    }
    if (can->loop_end_ns == SOC_NEVER) {
        const int m = bxcan_next(can, &frame);
        if (m >= 0) {
            bxcan_begin(can, m);
            can->loop_end_ns = soc_now_ns(can->soc) + (47U + 8U * frame.length) * bit_ns(can);
        }
    } else if (can->loop_end_ns <= soc_now_ns(can->soc)) {
        can->loop_end_ns = SOC_NEVER;
        if (can->on_wire >= 0) {
            frame = bxcan_frame_of(&can->mailbox[can->on_wire]);
            bxcan_end(can, BXCAN_SENT);
            bxcan_hear(can, &frame);
        }
    }
}

void bxcan_settle(struct bxcan *can) {
    notice_errors(can);
    change_mode(can);
    recover(can);
    update_interrupts(can);
    schedule(can);
    if (can->port != NULL) {
        can->port->changed(can->port->context);
    }
}

void bxcan_due(struct bxcan *can) {
    loop_back(can);
    bxcan_settle(can);
}

void bxcan_connect(struct bxcan *can, const struct bxcan_port *port) {
    can->port = port;
    bxcan_settle(can);
}

void bxcan_reset(struct bxcan *can, struct soc *soc, unsigned index) {
    const struct bxcan_port *port = can->port;
    memset(can, 0, sizeof *can);
    can->soc = soc;
    can->index = (uint8_t)index;
    can->mcr = MCR_AT_RESET;
    can->msr = MSR_SLAK;
    can->btr = BTR_AT_RESET;
    can->on_wire = -1;
    can->loop_end_ns = can->mode_change_ns = SOC_NEVER;
    can->port = port;
    if (index == 0U) {
        bxcan_filters_reset(&soc->filters);
    }
    bxcan_settle(can);
}

// ---------------------------------------------------------------- registers

static uint32_t read_fifo_status(const struct bxcan_fifo *fifo) {
    return fifo->count | (fifo->full ? 8U : 0U) | (fifo->overrun ? 16U : 0U);
}

/// Registers of a mailbox or of the oldest frame in a queue.
static uint32_t read_slot(const struct bxcan_mailbox *slot, uint32_t offset) {
    switch (offset & 0xCU) {
    case 0x0:
        return slot->id;
    case 0x4:
        return slot->length;
    case 0x8:
        return slot->low;
    default:
        return slot->high;
    }
}

uint32_t bxcan_read(void *model, uint32_t offset) {
    struct bxcan *can = model;
    switch (offset) {
    case 0x00:
        return can->mcr;
    case 0x04:
        return can->msr | MSR_LINE | (can->on_wire >= 0 ? MSR_TXM : 0U);
    case 0x08:
        return bxcan_read_tsr(can);
    case 0x0C:
    case 0x10:
        return read_fifo_status(&can->fifo[(offset - 0x0CU) / 4U]);
    case 0x14:
        return can->ier;
    case 0x18:
        return read_esr(can);
    case 0x1C:
        return can->btr;
    default:
        break;
    }
    if (offset >= 0x180U && offset < 0x1B0U) {
        return read_slot(&can->mailbox[(offset - 0x180U) / 16U], offset);
    }
    if (offset >= 0x1B0U && offset < 0x1D0U) {
        const struct bxcan_fifo *fifo = &can->fifo[(offset - 0x1B0U) / 16U];
        return fifo->count != 0U ? read_slot(&fifo->slot[0], offset) : 0U;
    }
    return can->index == 0U ? bxcan_filters_read(&can->soc->filters, offset) : 0U;
}

static void write_mcr(struct bxcan *can, uint32_t value) {
    if ((value & MCR_RESET) != 0U) {
        bxcan_reset(can, can->soc, can->index);
        return;
    }
    can->mcr = value & MCR_BITS;
    if ((value & MCR_TTCM) != 0U) {
        soc_complain(can->soc, "CAN%u: time-triggered mode has no model", can->index + 1U);
    }
}

static void release(struct bxcan_fifo *fifo, uint32_t value) {
    fifo->full = fifo->full && (value & 8U) == 0U;
    fifo->overrun = fifo->overrun && (value & 16U) == 0U;
    if ((value & 32U) != 0U && fifo->count != 0U) {
        memmove(&fifo->slot[0], &fifo->slot[1], sizeof fifo->slot - sizeof fifo->slot[0]);
        fifo->count--;
    }
}

static void write_btr(struct bxcan *can, uint32_t value) {
    if (in_init(can)) {
        can->btr = value & BTR_BITS;
    } else {
        soc_complain(can->soc, "CAN%u: BTR is written outside of initialisation mode",
                     can->index + 1U);
    }
}

void bxcan_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes) {
    struct bxcan *can = model;
    (void)lanes;
    switch (offset) {
    case 0x00:
        write_mcr(can, value);
        break;
    case 0x04:
        can->msr &= ~(value & (MSR_ERRI | MSR_WKUI | MSR_SLAKI));
        break;
    case 0x08:
        bxcan_write_tsr(can, value);
        break;
    case 0x0C:
    case 0x10:
        release(&can->fifo[(offset - 0x0CU) / 4U], value);
        break;
    case 0x14:
        can->ier = value & IER_BITS;
        break;
    case 0x18:
        can->lec = value >> 4 & 7U;
        break;
    case 0x1C:
        write_btr(can, value);
        break;
    default:
        if (offset >= 0x180U && offset < 0x1B0U) {
            bxcan_write_mailbox(can, offset, value);
        } else if (can->index == 0U) {
            bxcan_filters_write(&can->soc->filters, offset, value);
        }
        break;
    }
    loop_back(can);
    bxcan_settle(can);
}

/// Mailboxes, receive queues and error counters of bxCAN: RM0090, 32.7.1 to 32.7.6.
#include "mcu/bxcan.h"

#include "mcu/soc.h"

#define TXRQ            1U
#define ID_RTR          2U
#define ID_IDE          4U
#define MCR_TXFP        (UINT32_C(1) << 2)
#define MCR_RFLM        (UINT32_C(1) << 3)
#define MCR_NART        (UINT32_C(1) << 4)
#define TSR_RQCP        1U
#define TSR_TXOK        2U
#define TSR_ALST        4U
#define TSR_TERR        8U
#define TSR_ABRQ        0x80U
#define TSR_RESULTS     (TSR_RQCP | TSR_TXOK | TSR_ALST | TSR_TERR)
#define LENGTH_BITS     0xFFFF010FU
#define TEC_BUS_OFF     256U
#define REC_PASSIVE     128U
#define REC_AFTER_RIGHT 120U

// ---------------------------------------------------------------- error counters

void bxcan_count_error(struct bxcan *can, bool as_sender, unsigned lec) {
    const bool passive = can->tec > 127U || can->rec > 127U;
    can->lec = lec;
    can->lec_is_new = true;
    if (!as_sender) {
        can->rec = can->rec < 255U ? can->rec + 1U : 255U;
    } else if (!(passive && lec == BXCAN_LEC_ACK)) {
        // An error passive sender that nobody acknowledges does not count on: alone on the bus it
        // would switch itself off.
        can->tec += 8U;
    }
    if (can->tec >= TEC_BUS_OFF) {
        can->bus_off = true;
    }
}

void bxcan_count_success(struct bxcan *can, bool as_sender) {
    can->lec = BXCAN_LEC_NONE;
    if (as_sender) {
        can->tec -= can->tec != 0U ? 1U : 0U;
    } else if (can->rec > REC_PASSIVE) {
        can->rec = REC_AFTER_RIGHT;
    } else {
        can->rec -= can->rec != 0U ? 1U : 0U;
    }
}

// ---------------------------------------------------------------- mailboxes

static bool is_pending(const struct bxcan *can, unsigned m) {
    return (can->mailbox[m].id & TXRQ) != 0U;
}

/// The arbitration field as a number: lower goes first.
static uint32_t priority_of(const struct bxcan_mailbox *mailbox) {
    const uint32_t standard = mailbox->id >> 21, rtr = (mailbox->id & ID_RTR) != 0U;
    if ((mailbox->id & ID_IDE) == 0U) {
        return standard << 21 | rtr << 20;
    }
    return standard << 21 | UINT32_C(3) << 19 | (mailbox->id >> 3 & 0x3FFFFU) << 1 | rtr;
}

/// Does mailbox a go before mailbox b?
static bool goes_before(const struct bxcan *can, unsigned a, unsigned b) {
    const struct bxcan_mailbox *x = &can->mailbox[a], *y = &can->mailbox[b];
    if ((can->mcr & MCR_TXFP) != 0U) {
        return (int32_t)(x->order - y->order) < 0;
    }
    const uint32_t first = priority_of(x), second = priority_of(y);
    return first != second ? first < second : a < b;
}

struct can_frame bxcan_frame_of(const struct bxcan_mailbox *mailbox) {
    struct can_frame frame = {0};
    const bool extended = (mailbox->id & ID_IDE) != 0U;
    frame.id = extended ? mailbox->id >> 3 : mailbox->id >> 21;
    frame.flags = (uint8_t)((extended ? CAN_FRAME_EXTENDED : 0) |
                            ((mailbox->id & ID_RTR) != 0U ? CAN_FRAME_REMOTE : 0));
    frame.length = mailbox->length & 15U;
    frame.length = frame.length > 8U ? 8U : frame.length;
    for (unsigned i = 0; i < 8U; i++) {
        frame.data[i] = (uint8_t)((i < 4U ? mailbox->low : mailbox->high) >> (8U * (i % 4U)));
    }
    return frame;
}

int bxcan_next(const struct bxcan *can, struct can_frame *frame) {
    int best = -1;
    for (unsigned m = 0; m < BXCAN_MAILBOXES; m++) {
        if (is_pending(can, m) && (best < 0 || goes_before(can, m, (unsigned)best))) {
            best = (int)m;
        }
    }
    if (best >= 0 && frame != NULL) {
        *frame = bxcan_frame_of(&can->mailbox[best]);
    }
    return best;
}

/// The mailbox is empty again.
static void complete(struct bxcan *can, unsigned m, uint32_t result) {
    can->mailbox[m].id &= ~TXRQ;
    can->mailbox[m].abort = false;
    can->tsr &= ~(TSR_RESULTS << (8U * m));
    can->tsr |= (TSR_RQCP | result) << (8U * m);
}

/// An attempt failed: again, unless single shots are asked for or the request was withdrawn.
static void fail(struct bxcan *can, unsigned m, uint32_t why) {
    if ((can->mcr & MCR_NART) != 0U || can->mailbox[m].abort) {
        complete(can, m, why);
    } else {
        can->tsr = (can->tsr & ~(TSR_TXOK << (8U * m))) | why << (8U * m);
    }
}

void bxcan_begin(struct bxcan *can, int mailbox) {
    can->on_wire = mailbox;
}

void bxcan_lost_arbitration(struct bxcan *can, int mailbox) {
    fail(can, (unsigned)mailbox, TSR_ALST);
    bxcan_settle(can);
}

void bxcan_end(struct bxcan *can, enum bxcan_result result) {
    const int m = can->on_wire;
    can->on_wire = -1;
    if (m < 0) {
        return; // a reset came between
    }
    if (result == BXCAN_SENT) {
        bxcan_count_success(can, true);
        complete(can, (unsigned)m, TSR_TXOK);
    } else {
        bxcan_count_error(can, true,
                          result == BXCAN_NO_ACKNOWLEDGE ? BXCAN_LEC_ACK : BXCAN_LEC_BIT_RECESSIVE);
        fail(can, (unsigned)m, TSR_TERR);
    }
    bxcan_settle(can);
}

void bxcan_write_mailbox(struct bxcan *can, uint32_t offset, uint32_t value) {
    const unsigned m = (offset - 0x180U) / 16U;
    struct bxcan_mailbox *mailbox = &can->mailbox[m];
    if (is_pending(can, m)) {
        soc_complain(can->soc, "CAN%u: a mailbox is written while its frame waits",
                     can->index + 1U);
        return;
    }
    switch (offset & 0xCU) {
    case 0x0:
        mailbox->id = value;
        if ((value & TXRQ) != 0U) {
            mailbox->order = can->order++;
            can->tsr &= ~(TSR_RESULTS << (8U * m));
        }
        break;
    case 0x4:
        mailbox->length = value & LENGTH_BITS;
        break;
    case 0x8:
        mailbox->low = value;
        break;
    default:
        mailbox->high = value;
        break;
    }
    bxcan_settle(can);
}

void bxcan_write_tsr(struct bxcan *can, uint32_t value) {
    for (unsigned m = 0; m < BXCAN_MAILBOXES; m++) {
        const uint32_t bits = value >> (8U * m);
        if ((bits & TSR_RQCP) != 0U) { // clears the results with it
            can->tsr &= ~(TSR_RESULTS << (8U * m));
        }
        can->tsr &= ~((bits & (TSR_TXOK | TSR_ALST | TSR_TERR)) << (8U * m));
        if ((bits & TSR_ABRQ) != 0U && is_pending(can, m)) {
            if (can->on_wire == (int)m) {
                can->mailbox[m].abort = true; // decided when the frame has ended
            } else {
                complete(can, m, 0);
            }
        }
    }
    bxcan_settle(can);
}

uint32_t bxcan_read_tsr(const struct bxcan *can) {
    uint32_t value = can->tsr, pending = 0;
    int last = -1, empty = -1;
    for (unsigned m = 0; m < BXCAN_MAILBOXES; m++) {
        value |= can->mailbox[m].abort ? TSR_ABRQ << (8U * m) : 0U;
        if (!is_pending(can, m)) {
            value |= UINT32_C(1) << (26U + m); // TME
            empty = empty < 0 ? (int)m : empty;
        } else {
            pending++;
            last = last < 0 || goes_before(can, (unsigned)last, m) ? (int)m : last;
        }
    }
    if (pending > 1U) {
        value |= UINT32_C(1) << (29U + (unsigned)last); // LOW
    }
    return value | (uint32_t)(empty >= 0 ? empty : last) << 24;
}

// ---------------------------------------------------------------- reception

static void store(struct bxcan *can, const struct can_frame *frame, struct bxcan_match match) {
    struct bxcan_fifo *fifo = &can->fifo[match.fifo];
    if (fifo->count == BXCAN_FIFO_DEPTH) {
        fifo->overrun = true;
        if ((can->mcr & MCR_RFLM) != 0U) {
            return; // locked: the new one is lost
        }
        fifo->count--; // the last one is overwritten
    }
    struct bxcan_mailbox *slot = &fifo->slot[fifo->count++];
    const bool extended = (frame->flags & CAN_FRAME_EXTENDED) != 0U;
    slot->id = extended ? frame->id << 3 | ID_IDE : frame->id << 21;
    slot->id |= (frame->flags & CAN_FRAME_REMOTE) != 0U ? ID_RTR : 0U;
    slot->length = frame->length | (uint32_t)match.number << 8;
    slot->low = slot->high = 0;
    for (unsigned i = 0; i < frame->length; i++) {
        uint32_t *word = i < 4U ? &slot->low : &slot->high;
        *word |= (uint32_t)frame->data[i] << (8U * (i % 4U));
    }
    fifo->full = fifo->full || fifo->count == BXCAN_FIFO_DEPTH;
}

void bxcan_hear(struct bxcan *can, const struct can_frame *frame) {
    const struct bxcan_filters *filters = &can->soc->filters;
    bxcan_count_success(can, false);
    if (!bxcan_filters_initialising(filters)) {
        const struct bxcan_match match = bxcan_filters_match(filters, can->index, frame);
        if (match.passes) {
            store(can, frame, match);
        }
    }
    bxcan_settle(can);
}

void bxcan_hear_error(struct bxcan *can) {
    bxcan_count_error(can, false, BXCAN_LEC_STUFF);
    bxcan_settle(can);
}

/// The CAN controllers (bxCAN) and their filters.
///
/// Source: RM0090, chapter 32; error counters: Bosch CAN 2.0B, section 8. Three mailboxes sent by
/// identifier or in order (TXFP), abort, single shot (NART); two receive queues of three with
/// overrun and lock (RFLM); 28 filter banks in all four kinds with their numbers and priorities;
/// error counters, error passive, bus-off and the way back (ABOM or by software); sleep,
/// initialisation, silent and loop-back modes; all interrupts.
///
/// The model knows no wires: a bus (can_port.h, or a test) asks bxcan_next for what should be sent
/// and tells what happened. Without one the bus is silent and nobody acknowledges. Left out:
/// time-triggered mode (complains), waking by the bus, in loop-back mode without silent mode the
/// copy of the frames on the bus. What the manual leaves open: in bus-off and in initialisation
/// mode mailboxes stay pending. Shown: tests/mcu/bxcan.c, tests/mcu/bxcan_filters.c,
/// tests/mcu/bxcan_errors.c.
#ifndef MCU_BXCAN_H
#define MCU_BXCAN_H

#include "drive/can_frame.h"

#include <stdbool.h>
#include <stdint.h>

struct soc;

enum { BXCAN_BANKS = 28, BXCAN_MAILBOXES = 3, BXCAN_FIFO_DEPTH = 3 };

struct bxcan_filters {
    uint32_t fmr, list_mode, scale_32, fifo, active; ///< the last four: a bit for each bank
    uint32_t bank[BXCAN_BANKS][2];
};

struct bxcan_match {
    bool passes;
    uint8_t fifo;
    uint8_t number; ///< FMI
};

/// What became of an attempt to send.
enum bxcan_result {
    BXCAN_SENT,
    BXCAN_NO_ACKNOWLEDGE, ///< nobody else on the bus
    BXCAN_BIT_ERROR,      ///< the bus had another level than what was sent
};

/// The codes of ESR.LEC.
enum { BXCAN_LEC_NONE, BXCAN_LEC_STUFF, BXCAN_LEC_FORM, BXCAN_LEC_ACK, BXCAN_LEC_BIT_RECESSIVE };

struct bxcan_mailbox {
    uint32_t id, length, low, high; ///< the four registers; TXRQ is bit 0 of id
    uint32_t order;                 ///< of the requests
    bool abort;
};

struct bxcan_fifo {
    struct bxcan_mailbox slot[BXCAN_FIFO_DEPTH];
    uint32_t count;
    bool full, overrun;
};

/// What a controller asks of its bus.
struct bxcan_port {
    /// What it wants to send, or whether it takes part, may have changed.
    void (*changed)(void *context);
    /// How often 11 recessive bits in a row have passed since the beginning.
    uint64_t (*quiet_stretches)(void *context);
    /// Is a frame on the bus?
    bool (*busy)(void *context);
    void *context;
};

struct bxcan {
    struct soc *soc;
    uint8_t index;
    uint32_t mcr, msr, tsr, ier, btr;
    uint32_t lec;
    bool lec_is_new;     ///< set by the hardware since the last look
    uint32_t seen_flags; ///< of ESR, at the last look
    uint32_t tec;        ///< up to 256 and more: bus-off
    uint32_t rec;
    bool bus_off;
    struct bxcan_mailbox mailbox[BXCAN_MAILBOXES];
    struct bxcan_fifo fifo[2];
    uint32_t order;       ///< of the next request
    int on_wire;          ///< mailbox that is being sent; -1: none
    uint64_t loop_end_ns; ///< of a frame in loop-back mode
    // Waiting for recessive bits: to leave initialisation or sleep (1 stretch), or bus-off (128).
    bool synchronising, recovering;
    uint64_t quiet_from;
    uint64_t mode_change_ns; ///< when a mode that was asked for is entered; SOC_NEVER: none
    const struct bxcan_port *port;
};

void bxcan_reset(struct bxcan *can, struct soc *soc, unsigned index);
void bxcan_due(struct bxcan *can);
uint32_t bxcan_read(void *model, uint32_t offset);
void bxcan_write(void *model, uint32_t offset, uint32_t value, uint32_t lanes);

/// The wires; NULL: none. Survives resets.
void bxcan_connect(struct bxcan *can, const struct bxcan_port *port);

/// Length of a bit as programmed, in picoseconds.
uint64_t bxcan_bit_ps(const struct bxcan *can);

/// Does it drive the bus: acknowledge, send, destroy? Not in sleep, initialisation, silent or
/// loop-back mode nor in bus-off.
bool bxcan_takes_part(const struct bxcan *can);
/// Does it hear the bus?
bool bxcan_listens(const struct bxcan *can);

// ---------------------------------------------------------------- what the bus tells

/// The frame that should go next. Returns its mailbox; -1: none.
int bxcan_next(const struct bxcan *can, struct can_frame *frame);

/// That frame is on the wire now.
void bxcan_begin(struct bxcan *can, int mailbox);
/// It wanted to go, but another node's frame had the lower identifier.
void bxcan_lost_arbitration(struct bxcan *can, int mailbox);
/// The frame on the wire has ended.
void bxcan_end(struct bxcan *can, enum bxcan_result result);

/// Another node's frame, whole; and one that was destroyed.
void bxcan_hear(struct bxcan *can, const struct can_frame *frame);
void bxcan_hear_error(struct bxcan *can);

// ---------------------------------------------------------------- for the files of the model

void bxcan_filters_reset(struct bxcan_filters *filters);
uint32_t bxcan_filters_read(const struct bxcan_filters *filters, uint32_t offset);
void bxcan_filters_write(struct bxcan_filters *filters, uint32_t offset, uint32_t value);
/// index: which controller; the banks are shared out between the two.
struct bxcan_match bxcan_filters_match(const struct bxcan_filters *filters, unsigned index,
                                       const struct can_frame *frame);
/// Reception stands still while the filters are being set up.
bool bxcan_filters_initialising(const struct bxcan_filters *filters);

/// Recomputes flags, interrupts and events after any change.
void bxcan_settle(struct bxcan *can);
/// A mailbox register is written; and the abort bits of TSR.
void bxcan_write_mailbox(struct bxcan *can, uint32_t offset, uint32_t value);
void bxcan_write_tsr(struct bxcan *can, uint32_t value);
uint32_t bxcan_read_tsr(const struct bxcan *can);
struct can_frame bxcan_frame_of(const struct bxcan_mailbox *mailbox);
/// An error or a success, for the counters. lec: BXCAN_LEC_*.
void bxcan_count_error(struct bxcan *can, bool as_sender, unsigned lec);
void bxcan_count_success(struct bxcan *can, bool as_sender);

#endif

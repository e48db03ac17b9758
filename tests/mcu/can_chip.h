/// A chip whose CAN controller works, for the tests of that: registers as in RM0090, 32.9.
#ifndef TESTS_MCU_CAN_CHIP_H
#define TESTS_MCU_CAN_CHIP_H

#include "chip.h"

#define MCR             (CAN1 + 0x00U)
#define MSR             (CAN1 + 0x04U)
#define TSR             (CAN1 + 0x08U)
#define RF0R            (CAN1 + 0x0CU)
#define RF1R            (CAN1 + 0x10U)
#define IER             (CAN1 + 0x14U)
#define ESR             (CAN1 + 0x18U)
#define BTR             (CAN1 + 0x1CU)
#define TIR(m)          (CAN1 + 0x180U + 16U * (m))
#define TDTR(m)         (CAN1 + 0x184U + 16U * (m))
#define TDLR(m)         (CAN1 + 0x188U + 16U * (m))
#define TDHR(m)         (CAN1 + 0x18CU + 16U * (m))
#define RIR(f)          (CAN1 + 0x1B0U + 16U * (f))
#define RDTR(f)         (CAN1 + 0x1B4U + 16U * (f))
#define RDLR(f)         (CAN1 + 0x1B8U + 16U * (f))
#define RDHR(f)         (CAN1 + 0x1BCU + 16U * (f))
#define FMR             (CAN1 + 0x200U)
#define FM1R            (CAN1 + 0x204U)
#define FS1R            (CAN1 + 0x20CU)
#define FFA1R           (CAN1 + 0x214U)
#define FA1R            (CAN1 + 0x21CU)
#define FR(bank, which) (CAN1 + 0x240U + 8U * (bank) + 4U * (which))

#define INRQ 1U
#define INAK 1U
#define TXRQ 1U
#define ABRQ 0x80U

/// 16 MHz, 1 Mbit/s: 16 quanta of 1 with BS1 13, BS2 2.
#define BTR_1_MBIT (UINT32_C(12) << 16 | UINT32_C(1) << 20)

/// One filter that lets everything into FIFO 0.
static inline void let_everything_in(void) {
    poke(FMR, peek(FMR) | 1U);
    poke(FS1R, 1);
    poke(FR(0, 0), 0);
    poke(FR(0, 1), 0);
    poke(FA1R, 1);
    poke(FMR, peek(FMR) & ~1U);
}

/// Out of reset into normal mode (RM0090, 32.4).
static inline void start_can(uint32_t mcr) {
    power_on();
    clock_everything();
    poke(MCR, mcr | INRQ);
    pass_us(10);
    poke(BTR, BTR_1_MBIT);
    let_everything_in();
    poke(MCR, mcr);
    pass_us(50);
}

/// Asks for a frame with a standard identifier, without data.
static inline void request(unsigned m, uint32_t id) {
    poke(TDTR(m), 0);
    poke(TIR(m), id << 21 | TXRQ);
}

/// The bus takes what goes next. Returns its mailbox.
static inline int carry(enum bxcan_result result) {
    const int m = bxcan_next(&chip.can[0], NULL);
    if (m >= 0) {
        bxcan_begin(&chip.can[0], m);
        bxcan_end(&chip.can[0], result);
    }
    return m;
}

static inline void hear(uint32_t id) {
    const struct can_frame frame = {.id = id, .length = 1, .data = {(uint8_t)id}};
    bxcan_hear(&chip.can[0], &frame);
}

#endif

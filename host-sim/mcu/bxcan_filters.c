/// The filter banks of bxCAN: RM0090, 32.7.4.
#include "mcu/bxcan.h"

#include <string.h>

#define FMR_FINIT      1U
#define FMR_RESET      0x2A1C0E01U
#define FMR_CAN2SB     0x3F00U
#define BANKS          0x0FFFFFFFU
#define ID_STANDARD_AT 21
#define ID_EXTENDED_AT 3
#define ID_IDE         4U
#define ID_RTR         2U

void bxcan_filters_reset(struct bxcan_filters *filters) {
    memset(filters, 0, sizeof *filters);
    filters->fmr = FMR_RESET;
}

bool bxcan_filters_initialising(const struct bxcan_filters *filters) {
    return (filters->fmr & FMR_FINIT) != 0U;
}

uint32_t bxcan_filters_read(const struct bxcan_filters *filters, uint32_t offset) {
    switch (offset) {
    case 0x200:
        return filters->fmr;
    case 0x204:
        return filters->list_mode;
    case 0x20C:
        return filters->scale_32;
    case 0x214:
        return filters->fifo;
    case 0x21C:
        return filters->active;
    default:
        break;
    }
    if (offset >= 0x240U && offset < 0x240U + 8U * BXCAN_BANKS) {
        return filters->bank[(offset - 0x240U) / 8U][offset / 4U % 2U];
    }
    return 0;
}

void bxcan_filters_write(struct bxcan_filters *filters, uint32_t offset, uint32_t value) {
    const bool init = bxcan_filters_initialising(filters);
    switch (offset) {
    case 0x200:
        filters->fmr = (FMR_RESET & ~(FMR_CAN2SB | FMR_FINIT)) | (value & (FMR_CAN2SB | FMR_FINIT));
        return;
    case 0x204:
        filters->list_mode = init ? value & BANKS : filters->list_mode;
        return;
    case 0x20C:
        filters->scale_32 = init ? value & BANKS : filters->scale_32;
        return;
    case 0x214:
        filters->fifo = init ? value & BANKS : filters->fifo;
        return;
    case 0x21C:
        filters->active = value & BANKS;
        return;
    default:
        break;
    }
    if (offset >= 0x240U && offset < 0x240U + 8U * BXCAN_BANKS) {
        const unsigned bank = (offset - 0x240U) / 8U;
        if (init || (filters->active >> bank & 1U) == 0U) {
            filters->bank[bank][offset / 4U % 2U] = value;
        }
    }
}

// ---------------------------------------------------------------- matching

/// How a 32-bit filter sees a frame: STID, EXID, IDE, RTR, 0.
static uint32_t wide_view(const struct can_frame *frame) {
    const uint32_t rtr = (frame->flags & CAN_FRAME_REMOTE) != 0U ? ID_RTR : 0U;
    if ((frame->flags & CAN_FRAME_EXTENDED) != 0U) {
        return frame->id << ID_EXTENDED_AT | ID_IDE | rtr;
    }
    return frame->id << ID_STANDARD_AT | rtr;
}

/// And a 16-bit one: STID, RTR, IDE, EXID[17:15].
static uint32_t narrow_view(uint32_t wide) {
    return (wide >> 16 & 0xFFE0U) | (wide & ID_RTR) << 3 | (wide & ID_IDE) << 1 | (wide >> 18 & 7U);
}

/// Which of a bank's filters (0 to 3) passes; -1: none.
static int match_bank(const struct bxcan_filters *filters, unsigned bank, uint32_t wide) {
    const uint32_t a = filters->bank[bank][0], b = filters->bank[bank][1];
    const bool list = (filters->list_mode >> bank & 1U) != 0U;
    if ((filters->scale_32 >> bank & 1U) != 0U) {
        if (list) {
            return ((a ^ wide) & ~1U) == 0U ? 0 : ((b ^ wide) & ~1U) == 0U ? 1 : -1;
        }
        return ((a ^ wide) & b & ~1U) == 0U ? 0 : -1;
    }
    const uint32_t narrow = narrow_view(wide);
    const uint32_t halves[] = {a & 0xFFFFU, a >> 16, b & 0xFFFFU, b >> 16};
    for (int i = 0; list && i < 4; i++) {
        if (halves[i] == narrow) {
            return i;
        }
    }
    for (int i = 0; !list && i < 2; i++) {
        if (((halves[2 * i] ^ narrow) & halves[2 * i + 1]) == 0U) {
            return i;
        }
    }
    return -1;
}

/// How many filters a bank counts for, active or not.
static unsigned filters_in(const struct bxcan_filters *filters, unsigned bank) {
    const unsigned list = filters->list_mode >> bank & 1U;
    return (filters->scale_32 >> bank & 1U) != 0U ? 1U + list : 2U + 2U * list;
}

struct bxcan_match bxcan_filters_match(const struct bxcan_filters *filters, unsigned index,
                                       const struct can_frame *frame) {
    const uint32_t wide = wide_view(frame);
    const unsigned split = filters->fmr >> 8 & 0x3FU;
    const unsigned border = split < BXCAN_BANKS ? split : BXCAN_BANKS;
    const unsigned first = index == 0U ? 0U : border, end = index == 0U ? border : BXCAN_BANKS;
    struct bxcan_match best = {false, 0, 0};
    unsigned best_rank = 4, number[2] = {0, 0};
    for (unsigned bank = first; bank < end; bank++) {
        const unsigned fifo = filters->fifo >> bank & 1U;
        const int which =
            (filters->active >> bank & 1U) != 0U ? match_bank(filters, bank, wide) : -1;
        // 32 bits before 16, then lists before masks, then the lower number.
        const unsigned rank =
            2U * (1U - (filters->scale_32 >> bank & 1U)) + (1U - (filters->list_mode >> bank & 1U));
        if (which >= 0 && rank < best_rank) {
            best_rank = rank;
            best = (struct bxcan_match){true, (uint8_t)fifo,
                                        (uint8_t)(number[fifo] + (unsigned)which)};
        }
        number[fifo] += filters_in(filters, bank);
    }
    return best;
}

/// A frame of classic CAN (ISO 11898-1), as a value: what drives are spoken to in, what the bus of
/// the simulator carries, what a HAL sends and receives.
///
/// Linux' <linux/can.h> has a `struct can_frame` of its own. A file that needs both renames the
/// kernel's while it includes it: `#define can_frame kernel_can_frame`, include, `#undef`.
#ifndef DRIVE_CAN_FRAME_H
#define DRIVE_CAN_FRAME_H

#include <stdbool.h>
#include <stdint.h>

enum can_frame_flag {
    /// 29-bit id; else 11-bit.
    CAN_FRAME_EXTENDED = 1,
    /// Asks for the frame of this id: length is the length asked for, data has no meaning.
    CAN_FRAME_REMOTE = 2,
    /// No frame, but the mark of one that an error destroyed. Only in recordings: a HAL neither
    /// takes nor gives it (errors are counted in hal_can_state).
    CAN_FRAME_ERROR = 4
};

#define CAN_FRAME_STANDARD_ID_MAX UINT32_C(0x7FF)
#define CAN_FRAME_EXTENDED_ID_MAX UINT32_C(0x1FFFFFFF)
#define CAN_FRAME_DATA_BYTES      8

struct can_frame {
    /// At most CAN_FRAME_STANDARD_ID_MAX, or CAN_FRAME_EXTENDED_ID_MAX with CAN_FRAME_EXTENDED.
    uint32_t id;
    /// CAN_FRAME_* or-ed; no other bit.
    uint8_t flags;
    /// 0 to 8 bytes.
    uint8_t length;
    /// Bytes from length on have no meaning.
    uint8_t data[CAN_FRAME_DATA_BYTES];
};

/// Whether a controller can put it on the bus: every field in its range, and no error mark.
static inline bool can_frame_is_valid(const struct can_frame *frame) {
    const uint32_t id_max = (frame->flags & CAN_FRAME_EXTENDED) != 0U ? CAN_FRAME_EXTENDED_ID_MAX
                                                                      : CAN_FRAME_STANDARD_ID_MAX;
    return (frame->flags & ~(unsigned)(CAN_FRAME_EXTENDED | CAN_FRAME_REMOTE)) == 0U &&
           frame->id <= id_max && frame->length <= CAN_FRAME_DATA_BYTES;
}

/// Whether both mean the same: data is compared as far as it has a meaning.
static inline bool can_frame_equal(const struct can_frame *a, const struct can_frame *b) {
    if (a->id != b->id || a->flags != b->flags || a->length != b->length) {
        return false;
    }
    if ((a->flags & CAN_FRAME_REMOTE) != 0U) {
        return true;
    }
    for (unsigned i = 0; i < a->length && i < CAN_FRAME_DATA_BYTES; i++) {
        if (a->data[i] != b->data[i]) {
            return false;
        }
    }
    return true;
}

#endif

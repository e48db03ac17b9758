/// One classic CAN frame, as every layer from the protocol codecs to the bus drivers passes it on.
#ifndef DRIVE_CAN_FRAME_H
#define DRIVE_CAN_FRAME_H

#include <stdint.h>

#define CAN_FRAME_EXTENDED 1U ///< id has 29 bits; without it, 11.
#define CAN_FRAME_REMOTE   2U ///< a request for data: length is the length asked for, data is unused.
#define CAN_FRAME_ERROR    4U ///< not a frame of the bus: the driver reports a bus error.

/// length: 0 to 8 data bytes. Unused bytes of data are 0, so that frames can be compared.
struct can_frame {
    uint32_t id;
    uint8_t flags;
    uint8_t length;
    uint8_t data[8];
};

#endif
